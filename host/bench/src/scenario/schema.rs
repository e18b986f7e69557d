//! The keys a section turned out to have, and what an unknown key was probably meant to be.

use super::error::Fault;
use super::tree::Value;
use super::unit;

/// How alike two keys must be (0 to 1) to take one for a misspelling of the other.
const ALIKE: f64 = 0.6;

/// The keys of a section, gathered while it is read.
#[derive(Default)]
pub(super) struct Schema {
    pub(super) known: Vec<KnownKey>,
    pub(super) elsewhere: Vec<Elsewhere>,
    /// Symbols of the paper and the key each stands for.
    pub(super) symbols: &'static [(&'static str, &'static str)],
}

/// A key of this section.
pub(super) struct KnownKey {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    /// What the key must be, if it is required and absent.
    pub(super) missing: Option<String>,
}

/// Keys that would be known had another choice been made.
pub(super) struct Elsewhere {
    /// The choice that has them.
    pub(super) owner: String,
    /// Who chose what instead.
    pub(super) chosen: String,
    pub(super) keys: Vec<KnownKey>,
}

impl Schema {
    pub(super) fn knows(&self, name: &str) -> bool {
        self.known.iter().any(|key| key.name == name)
    }

    /// The fault of an unknown key, and the key that was probably meant.
    pub(super) fn explain_unknown(&self, name: &str, value: &Value) -> (Fault, Option<&'static str>) {
        let found = value.to_string();
        let elsewhere = self.elsewhere.iter().find(|choice| choice.keys.iter().any(|key| key.name == name));
        if let Some(Elsewhere { owner, chosen, .. }) = elsewhere {
            let (owner, chosen) = (owner.clone(), chosen.clone());
            return (Fault::BelongsTo { found, owner, chosen }, None);
        }
        let symbol = self.symbols.iter().find(|(symbol, _)| symbol.eq_ignore_ascii_case(name));
        if let Some(key) = symbol.and_then(|(_, meant)| self.known.iter().find(|key| key.name == *meant)) {
            return (Fault::PaperSymbol { found, key: key.name, unit: key.unit }, Some(key.name));
        }
        let in_units = self.known.iter().filter(|key| !key.unit.is_empty());
        if let Some(key) = in_units.into_iter().find(|key| unit::same_quantity(key.name, name)) {
            return (Fault::WrongUnit { found, key: key.name, unit: key.unit }, Some(key.name));
        }
        match self.nearest(name) {
            Some(nearest) => (Fault::Misspelled { nearest }, Some(nearest)),
            None => {
                let known: Vec<_> = self.known.iter().map(|key| key.name).collect();
                (Fault::Unknown { known: known.join(", ") }, None)
            }
        }
    }

    fn nearest(&self, name: &str) -> Option<&'static str> {
        let likeness = |key: &KnownKey| strsim::normalized_damerau_levenshtein(key.name, name);
        let best = self.known.iter().map(|key| (likeness(key), key.name)).max_by(|a, b| a.0.total_cmp(&b.0));
        best.filter(|(likeness, _)| *likeness >= ALIKE).map(|(_, name)| name)
    }
}
