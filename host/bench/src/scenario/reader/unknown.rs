//! The key that an unknown one was probably meant to be.

use crate::scenario::key::Keys;
use crate::scenario::key_error::KeyError;
use crate::scenario::origin::Origin;
use crate::scenario::spelling::nearest;
use crate::scenario::tree::{Node, Value};
use crate::scenario::unit;

/// What is known of a section with an unknown key.
pub(super) struct Known<'a> {
    /// Names and units of the keys that were read.
    pub(super) keys: &'a [(&'static str, &'static str)],
    /// The keys under every choice.
    pub(super) declared: &'a Keys,
    /// The value that the file gives for a key.
    pub(super) given: &'a dyn Fn(&str) -> Option<&'a Node>,
}

impl Known<'_> {
    /// The error for an unknown key, and the key that was probably meant.
    pub(super) fn explain(&self, name: &str, value: &Value) -> (KeyError, Option<&'static str>) {
        let found = value.to_string();
        let other_name = |found, problem, &(key, unit): &(&'static str, &'static str)| {
            (KeyError::OtherName { found, problem, key, unit }, Some(key))
        };
        if let Some((owner, chosen)) = self.owner(self.declared, name) {
            return (KeyError::BelongsTo { found, owner, chosen }, None);
        }
        let symbol = self.declared.symbols.iter().find(|(symbol, _)| symbol.eq_ignore_ascii_case(name));
        if let Some(key) = symbol.and_then(|(_, meant)| self.keys.iter().find(|(key, _)| key == meant)) {
            return other_name(found, "given under a symbol of the paper", key);
        }
        let mut in_units = self.keys.iter().filter(|(_, unit)| !unit.is_empty());
        if let Some(key) = in_units.find(|(key, _)| unit::same_quantity(key, name)) {
            return other_name(found, "in a wrong unit", key);
        }
        match self.nearest(name) {
            Some(nearest) => (KeyError::Misspelled { nearest }, Some(nearest)),
            None => {
                let known: Vec<_> = self.keys.iter().map(|(key, _)| *key).collect();
                (KeyError::Unknown { known: known.join(", ") }, None)
            }
        }
    }

    /// The choice that has the key, and what chose otherwise.
    fn owner(&self, keys: &Keys, name: &str) -> Option<(String, String)> {
        keys.selectors.iter().filter(|selector| selector.names_owner).find_map(|selector| {
            let key = selector.key;
            let default = keys.keys.iter().find(|it| it.name == key).and_then(|it| it.default.as_ref());
            let given = (self.given)(key);
            let variant = |chosen: &str| selector.variants.iter().find(|(variant, _)| *variant == chosen);
            let chosen = given.and_then(|node| variant(node.text()?));
            let (chosen, nested) = chosen.or_else(|| variant(default?.text()?))?;
            self.owner(nested, name).or_else(|| {
                let has = |keys: &Keys| keys.keys.iter().any(|key| key.name == name);
                let (owner, _) = selector.variants.iter().find(|(_, keys)| has(keys))?;
                let chooser = given.and_then(|node| Origin::replacement(&node.origin));
                let chooser = chooser.unwrap_or_else(|| "the scenario".to_owned());
                let chosen = format!("{chooser} chooses {key} = \"{chosen}\"");
                Some((format!("{key} = \"{owner}\""), chosen))
            })
        })
    }

    fn nearest(&self, name: &str) -> Option<&'static str> {
        nearest(name, self.keys.iter().map(|(key, _)| *key))
    }
}
