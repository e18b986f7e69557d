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
        /// The key's column in characters, counted from 1.
        column: usize,
    },
    /// An option of the command line, as the user spelled it.
    Option(Arc<str>),
    /// A case of the file's sweep.
    Sweep {
        /// The file as the user named it.
        file: Arc<str>,
        /// Line of the axis, counted from 1.
        line: usize,
        /// Column of the axis in characters, counted from 1.
        column: usize,
        /// The replacement, `key=value`.
        setting: Arc<str>,
    },
}

impl Origin {
    /// Sort key for errors: down the file, then along the command line.
    pub(super) fn order(&self) -> (bool, usize) {
        match self {
            Self::File { line, .. } | Self::Sweep { line, .. } => (false, *line),
            Self::Option(_) => (true, 0),
        }
    }

    /// File, line and column; `None` for an option.
    #[must_use]
    pub fn place(&self) -> Option<(&Arc<str>, usize, usize)> {
        match self {
            Self::File { file, line, column } | Self::Sweep { file, line, column, .. } => {
                Some((file, *line, *column))
            }
            Self::Option(_) => None,
        }
    }

    /// What replaces a value of the file; `None` for the file's own value.
    #[must_use]
    pub fn replacement(&self) -> Option<String> {
        match self {
            Self::File { .. } => None,
            Self::Option(option) => Some(option.to_string()),
            Self::Sweep { setting, .. } => Some(format!("[sweep] {setting}")),
        }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { file, line, .. } => write!(f, "{file}:{line}"),
            Self::Option(option) => f.write_str(option),
            Self::Sweep { file, line, setting, .. } => write!(f, "{file}:{line}: [sweep] {setting}"),
        }
    }
}
