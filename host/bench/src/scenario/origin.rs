//! Where a value of a scenario is written.

use std::fmt;
use std::sync::Arc;

/// Where a value of a scenario is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A line of the scenario file.
    File {
        /// The file as the user named it.
        file: Arc<str>,
        /// The key's line, counted from 1.
        line: usize,
    },
    /// An option of the command line, as the user spelled it.
    Option(Arc<str>),
}

impl Origin {
    /// Sort key for errors: down the file, then along the command line.
    pub(super) fn order(&self) -> (bool, usize) {
        match self {
            Self::File { line, .. } => (false, *line),
            Self::Option(_) => (true, 0),
        }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { file, line } => write!(f, "{file}:{line}"),
            Self::Option(option) => f.write_str(option),
        }
    }
}
