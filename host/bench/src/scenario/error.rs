//! Errors of a scenario, each a sentence that starts with the place to correct.
//!
//! The place is `file:line`, or the option itself (`--set plant.substeps=0`) for a value of the command line. Key, value and
//! the allowed range follow:
//!
//! ```text
//! scenarios/x.toml:12: plant.stiffness_nm_rad: -1 is out of range; it must be >= 1e-6 and <= 1e6 N m/rad
//! ```

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::key_error::KeyError;
use super::origin::Origin;

/// One thing that is wrong with a scenario.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// The file can't be read, or can't be a scenario, for instance a folder.
    #[error("{}: {reason}", path.display())]
    Unusable {
        /// The file as the user named it.
        path: PathBuf,
        /// The operating system's reason, or what it is and what to do.
        reason: String,
    },
    /// The file isn't TOML.
    #[error("{file}:{line}:{column}: {reason}")]
    Syntax {
        /// The file as the user named it.
        file: Arc<str>,
        /// Counted from 1.
        line: usize,
        /// In characters, counted from 1.
        column: usize,
        /// What the TOML parser expected.
        reason: String,
    },
    /// An option that isn't of the form `section.key=value`.
    #[error("{option}: {reason}")]
    Option {
        /// The option as the user spelled it.
        option: Arc<str>,
        /// What is wrong with it.
        reason: String,
    },
    /// A key with an error.
    #[error("{origin}: {}{error}", if key.is_empty() { String::new() } else { format!("{key}: ") })]
    Key {
        /// Where it was written; for a missing key, where its section begins.
        origin: Origin,
        /// The whole path, such as `plant.initial.load_position_rad`; empty for the file as a whole.
        key: String,
        /// What is wrong.
        error: Box<KeyError>,
    },
}

impl ScenarioError {
    /// The error of a value that contradicts others. `reason` continues the sentence after `found`.
    pub(super) fn rejected(
        origin: &Origin,
        key: impl Into<String>,
        found: impl fmt::Display,
        reason: impl Into<String>,
    ) -> Self {
        let error = Box::new(KeyError::rejected(found, reason));
        Self::Key { origin: origin.clone(), key: key.into(), error }
    }

    /// Whether this is a missing key whose path begins with `inside`.
    pub(super) fn is_missing_inside(&self, inside: &str) -> bool {
        matches!(self, Self::Key { key, error, .. }
            if matches!(**error, KeyError::Missing { .. }) && key.starts_with(inside))
    }

    /// File, line and column, both from 1; `None` for an option of the command line.
    #[must_use]
    pub fn place(&self) -> Option<(String, usize, usize)> {
        match self {
            Self::Unusable { path, .. } => Some((path.display().to_string(), 1, 1)),
            Self::Syntax { file, line, column, .. } => Some((file.to_string(), *line, *column)),
            Self::Option { .. } => None,
            Self::Key { origin, .. } => {
                origin.place().map(|(file, line, column)| (file.to_string(), line, column))
            }
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn problem(&self) -> String {
        match self {
            Self::Unusable { reason, .. } | Self::Syntax { reason, .. } => reason.clone(),
            Self::Option { .. } => self.to_string(),
            Self::Key { origin: Origin::Sweep { setting, .. }, key, error } => {
                format!("[sweep] {setting}: {key}: {error}")
            }
            Self::Key { key, error, .. } => format!("{key}: {error}"),
        }
    }

    pub(super) fn order(&self) -> (bool, usize) {
        match self {
            Self::Key { origin, .. } => origin.order(),
            Self::Unusable { .. } | Self::Syntax { .. } => (false, 0),
            Self::Option { .. } => (true, 0),
        }
    }
}

/// Everything that is wrong with a scenario, one sentence per line.
#[derive(Debug)]
pub struct ScenarioErrors(Vec<ScenarioError>);

impl ScenarioErrors {
    pub(super) fn new(mut errors: Vec<ScenarioError>) -> Self {
        errors.sort_by_key(ScenarioError::order);
        Self(errors)
    }

    /// Each error, in the order of the file, then of the command line.
    pub fn iter(&self) -> std::slice::Iter<'_, ScenarioError> {
        self.0.iter()
    }
}

impl From<Vec<ScenarioError>> for ScenarioErrors {
    fn from(errors: Vec<ScenarioError>) -> Self {
        Self::new(errors)
    }
}

impl From<ScenarioError> for ScenarioErrors {
    fn from(error: ScenarioError) -> Self {
        Self(vec![error])
    }
}

impl fmt::Display for ScenarioErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{error}")?;
        }
        Ok(())
    }
}

impl std::error::Error for ScenarioErrors {}
