//! The keys of a section, and the key that an unknown one was probably meant to be.

use crate::scenario::key_error::KeyError;
use crate::scenario::tree::Value;
use crate::scenario::unit;

/// Similarity, 0 to 1, from which on a key counts as a misspelling of another.
const MIN_SIMILARITY: f64 = 0.6;

/// The keys of a section, collected while it is read.
#[derive(Default)]
pub(super) struct Schema {
    pub(super) known: Vec<KnownKey>,
    pub(super) elsewhere: Vec<Elsewhere>,
    /// Symbols of the paper, each with its key.
    pub(super) symbols: &'static [(&'static str, &'static str)],
}

/// A key of this section.
pub(super) struct KnownKey {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    /// What the key must be, if it is required and absent.
    pub(super) missing: Option<String>,
}

/// Keys that the section would have under another choice.
pub(super) struct Elsewhere {
    /// The choice that has them.
    pub(super) owner: String,
    /// What chose otherwise.
    pub(super) chosen: String,
    pub(super) keys: Vec<KnownKey>,
}

impl Schema {
    pub(super) fn knows(&self, name: &str) -> bool {
        self.known.iter().any(|key| key.name == name)
    }

    /// The error for an unknown key, and the key that was probably meant.
    pub(super) fn explain_unknown(&self, name: &str, value: &Value) -> (KeyError, Option<&'static str>) {
        let found = value.to_string();
        let other_name = |found, problem, &KnownKey { name: key, unit, .. }: &KnownKey| {
            (KeyError::OtherName { found, problem, key, unit }, Some(key))
        };
        let elsewhere = self.elsewhere.iter().find(|choice| choice.keys.iter().any(|key| key.name == name));
        if let Some(Elsewhere { owner, chosen, .. }) = elsewhere {
            let (owner, chosen) = (owner.clone(), chosen.clone());
            return (KeyError::BelongsTo { found, owner, chosen }, None);
        }
        let symbol = self.symbols.iter().find(|(symbol, _)| symbol.eq_ignore_ascii_case(name));
        if let Some(key) = symbol.and_then(|(_, meant)| self.known.iter().find(|key| key.name == *meant)) {
            return other_name(found, "given under a symbol of the paper", key);
        }
        let in_units = self.known.iter().filter(|key| !key.unit.is_empty());
        if let Some(key) = in_units.into_iter().find(|key| unit::same_quantity(key.name, name)) {
            return other_name(found, "in a wrong unit", key);
        }
        match self.nearest(name) {
            Some(nearest) => (KeyError::Misspelled { nearest }, Some(nearest)),
            None => {
                let known: Vec<_> = self.known.iter().map(|key| key.name).collect();
                (KeyError::Unknown { known: known.join(", ") }, None)
            }
        }
    }

    fn nearest(&self, name: &str) -> Option<&'static str> {
        let similarity = |key: &KnownKey| strsim::normalized_damerau_levenshtein(key.name, name);
        let best =
            self.known.iter().map(|key| (similarity(key), key.name)).max_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(similarity, _)| *similarity >= MIN_SIMILARITY).map(|(_, name)| name)
    }
}
