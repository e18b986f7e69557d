//! The keys of a section, and the key that an unknown one was probably meant to be.

use crate::scenario::key::{Further, Key};
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
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

/// A key of this section, and what was read.
pub(in crate::scenario) struct KnownKey {
    /// The declaration. A section in it is empty: its keys are in `inside`.
    pub(in crate::scenario) key: Key,
    /// What the key must be, if it is required and absent.
    pub(super) missing: Option<String>,
    /// Where the scenario gives it; `None` for an absent key.
    pub(in crate::scenario) origin: Option<Origin>,
    /// The number in force, if the key takes one.
    pub(in crate::scenario) number: Option<f64>,
    /// What was read in the section, or in the first one of the list.
    pub(in crate::scenario) inside: Option<SectionKeys>,
}

/// The keys that a section has declared.
pub(in crate::scenario) struct SectionKeys {
    pub(in crate::scenario) keys: Vec<KnownKey>,
    /// Keys that are declared elsewhere.
    pub(in crate::scenario) further: Further,
    /// Where the section begins.
    pub(in crate::scenario) origin: Origin,
}

/// Keys that the section would have under another choice.
pub(super) struct Elsewhere {
    /// The choice that has them.
    pub(super) owner: String,
    /// What chose otherwise.
    pub(super) chosen: String,
    pub(super) keys: Vec<&'static str>,
}

impl Schema {
    /// The entry of a key that has been declared.
    pub(super) fn entry(&mut self, name: &str) -> &mut KnownKey {
        let last = self.known.iter_mut().rev().find(|known| known.key.name == name);
        last.expect("a key is looked up before its value is recorded")
    }

    pub(super) fn knows(&self, name: &str) -> bool {
        self.known.iter().any(|known| known.key.name == name)
    }

    /// The error for an unknown key, and the key that was probably meant.
    pub(super) fn explain_unknown(&self, name: &str, value: &Value) -> (KeyError, Option<&'static str>) {
        let found = value.to_string();
        let other_name = |found, problem, KnownKey { key, .. }: &KnownKey| {
            let Key { name: key, unit, .. } = *key;
            (KeyError::OtherName { found, problem, key, unit }, Some(key))
        };
        let elsewhere = self.elsewhere.iter().find(|choice| choice.keys.contains(&name));
        if let Some(Elsewhere { owner, chosen, .. }) = elsewhere {
            let (owner, chosen) = (owner.clone(), chosen.clone());
            return (KeyError::BelongsTo { found, owner, chosen }, None);
        }
        let symbol = self.symbols.iter().find(|(symbol, _)| symbol.eq_ignore_ascii_case(name));
        if let Some(key) =
            symbol.and_then(|(_, meant)| self.known.iter().find(|known| known.key.name == *meant))
        {
            return other_name(found, "given under a symbol of the paper", key);
        }
        let in_units = self.known.iter().filter(|known| !known.key.unit.is_empty());
        if let Some(key) = in_units.into_iter().find(|known| unit::same_quantity(known.key.name, name)) {
            return other_name(found, "in a wrong unit", key);
        }
        match self.nearest(name) {
            Some(nearest) => (KeyError::Misspelled { nearest }, Some(nearest)),
            None => {
                let known: Vec<_> = self.known.iter().map(|known| known.key.name).collect();
                (KeyError::Unknown { known: known.join(", ") }, None)
            }
        }
    }

    fn nearest(&self, name: &str) -> Option<&'static str> {
        let similarity = |key: &'static str| (strsim::normalized_damerau_levenshtein(key, name), key);
        let best =
            self.known.iter().map(|known| similarity(known.key.name)).max_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(similarity, _)| *similarity >= MIN_SIMILARITY).map(|(_, name)| name)
    }
}
