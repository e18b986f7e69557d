//! What can be wrong with one key.

use std::fmt;

use lashloop_plant::reference::TableError;

/// What is wrong with one key, as the end of a sentence that starts with the key.
#[derive(Debug, thiserror::Error)]
pub enum KeyError {
    /// A required key is missing.
    #[error("is missing; it must be {allowed}")]
    Missing {
        /// What is allowed.
        allowed: String,
    },
    /// The value is of another type.
    #[error("{found} is {kind}; it must be {allowed}")]
    WrongType {
        /// The value as written.
        found: String,
        /// Its type, as a noun phrase.
        kind: &'static str,
        /// What is allowed.
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
    /// A text that isn't one of the choices.
    #[error("{found} is not a choice; it must be {allowed}")]
    NotAChoice {
        /// The value as written.
        found: String,
        /// The choices.
        allowed: String,
    },
    /// An unknown key that resembles a known one.
    #[error("unknown key; did you mean {nearest}?")]
    Misspelled {
        /// The nearest known key of this section.
        nearest: &'static str,
    },
    /// An unknown key that resembles no known one.
    #[error("unknown key; it must be one of {known}")]
    Unknown {
        /// The keys of this section.
        known: String,
    },
    /// A known quantity under another name: with another unit or none, or as a symbol of the paper.
    #[error("{found} is {problem}; write {key}, in {unit}")]
    OtherName {
        /// What is wrong with the name.
        problem: &'static str,
        /// The value as written.
        found: String,
        /// The key to use.
        key: &'static str,
        /// The unit of that key.
        unit: &'static str,
    },
    /// A key that belongs to another choice.
    #[error("{found} is given, but this key belongs to {owner} and {chosen}")]
    BelongsTo {
        /// The value as written.
        found: String,
        /// The choice that has the key.
        owner: String,
        /// What chose otherwise.
        chosen: String,
    },
    /// A value that contradicts others.
    #[error("{found} {reason}")]
    Rejected {
        /// The value as written.
        found: String,
        /// Why, and what is allowed.
        reason: String,
    },
    /// A reference table that can't be used.
    #[error("{0}")]
    Table(#[from] TableError),
}

impl KeyError {
    /// A value that contradicts others. `reason` continues the sentence after `found`.
    pub(super) fn rejected(found: impl fmt::Display, reason: impl Into<String>) -> Self {
        Self::Rejected { found: found.to_string(), reason: reason.into() }
    }
}
