//! What can be wrong with a scenario, each as one sentence that starts with the place to correct.
//!
//! A place is `file:line` for what the file says and the option itself (`--set plant.substeps=0`) for what
//! the command line says. Then comes the key, then the value found and what would have been allowed:
//!
//! ```text
//! scenarios/x.toml:12: plant.stiffness_nm_rad: -1 is out of range; it must be > 0 and <= 1e6 N m/rad
//! ```

use std::fmt;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use super::controller::ParameterSetting;
use lashloop_plant::reference::TableError;

/// Where a value of a scenario was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A line of the scenario file, counted from 1.
    File {
        /// The file as the user named it.
        file: Arc<str>,
        /// The line of the key.
        line: usize,
    },
    /// An option of the command line, spelled as the user spelled it.
    Option(Arc<str>),
}

impl Origin {
    /// Sorts errors the way a reader corrects them: down the file, then along the command line.
    fn order(&self) -> (bool, usize) {
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

/// What is wrong with one key.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// A key without a default isn't there.
    #[error("is missing; it must be {allowed}")]
    Missing {
        /// What it may be.
        allowed: String,
    },
    /// The value is of another type.
    #[error("{found} is {kind}; it must be {allowed}")]
    WrongType {
        /// The value as written.
        found: String,
        /// Its type in words.
        kind: &'static str,
        /// What it may be.
        allowed: String,
    },
    /// A number outside its range.
    #[error("{found} is out of range; it must be {allowed}")]
    OutOfRange {
        /// The value as written.
        found: String,
        /// The range with its unit.
        allowed: String,
    },
    /// A word that isn't one of the choices.
    #[error("{found} is not a choice; it must be {allowed}")]
    NotAChoice {
        /// The value as written.
        found: String,
        /// The choices.
        allowed: String,
    },
    /// No such key, but one that looks like it.
    #[error("unknown key; did you mean {nearest}?")]
    Misspelled {
        /// The nearest known key of this section.
        nearest: &'static str,
    },
    /// No such key, and none that looks like it.
    #[error("unknown key; it must be one of {known}")]
    Unknown {
        /// The keys of this section.
        known: String,
    },
    /// A known quantity with another unit in its name, or with none.
    #[error("{found} is in a wrong unit; write {key}, in {unit}")]
    WrongUnit {
        /// The value as written.
        found: String,
        /// The key to use.
        key: &'static str,
        /// The unit of that key.
        unit: &'static str,
    },
    /// A symbol of the paper in place of the key.
    #[error("{found} is given under a symbol of the paper; write {key}, in {unit}")]
    PaperSymbol {
        /// The value as written.
        found: String,
        /// The key to use.
        key: &'static str,
        /// The unit of that key.
        unit: &'static str,
    },
    /// A key that only another choice has.
    #[error("{found} is given, but this key belongs to {owner} and {chosen}")]
    BelongsTo {
        /// The value as written.
        found: String,
        /// The choice that has the key.
        owner: String,
        /// Who chose what instead.
        chosen: String,
    },
    /// The value alone is fine, but not together with the rest.
    #[error("{found} {reason}")]
    Rejected {
        /// The value as written.
        found: String,
        /// Why, and what to do.
        reason: String,
    },
    /// The table of a reference can't be used.
    #[error("{0}")]
    Table(#[from] TableError),
}

/// One thing that is wrong with a scenario.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// The file can't be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file as the user named it.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
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
    /// An option that isn't `section.key=value`.
    #[error("{option}: {reason}")]
    Option {
        /// The option as the user spelled it.
        option: Arc<str>,
        /// What is wrong with it.
        reason: String,
    },
    /// A key with a fault.
    #[error("{origin}: {key}: {fault}")]
    Key {
        /// Where it was written; for a missing key, where its section begins.
        origin: Origin,
        /// The whole path, such as `plant.initial.load_position_rad`.
        key: String,
        /// What is wrong.
        fault: Box<Fault>,
    },
}

impl ScenarioError {
    /// The error for a drive parameter that the drive refuses: only the drive knows its parameters, so this is
    /// found after connecting. `reason` continues the sentence after the value, for instance
    /// `is out of range; it must be >= 0 and <= 50 N m`.
    #[must_use]
    pub fn parameter(setting: &ParameterSetting, reason: impl Into<String>) -> Self {
        Self::Key {
            origin: setting.origin.clone(),
            key: format!("controller.parameters.{}", spell_key(&setting.name)),
            fault: Box::new(Fault::Rejected { found: setting.value.to_string(), reason: reason.into() }),
        }
    }

    /// Whether this is a missing key whose path begins with `inside`.
    pub(super) fn is_missing_inside(&self, inside: &str) -> bool {
        matches!(self, Self::Key { key, fault, .. }
            if matches!(**fault, Fault::Missing { .. }) && key.starts_with(inside))
    }

    fn order(&self) -> (bool, usize) {
        match self {
            Self::Key { origin, .. } => origin.order(),
            Self::Read { .. } | Self::Syntax { .. } => (false, 0),
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

impl<'a> IntoIterator for &'a ScenarioErrors {
    type Item = &'a ScenarioError;
    type IntoIter = std::slice::Iter<'a, ScenarioError>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
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

/// A key as TOML would spell it, with anything unprintable escaped and anything long cut.
pub(super) fn spell_key(key: &str) -> String {
    let bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare { shorten(key) } else { spell_text(key) }
}

/// A text value in quotes, with anything unprintable escaped and anything long cut.
pub(super) fn spell_text(text: &str) -> String {
    format!("{:?}", shorten(text))
}

/// Keeps a message readable when the value found is a whole page.
fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
