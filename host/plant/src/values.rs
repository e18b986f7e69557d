//! Values of a plant's keys, by name.

use std::collections::BTreeMap;

use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::PlantError;

/// The value of one key.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub enum PlantValue {
    /// A number in the unit of its key.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// True or false; inside a free table only.
    Boolean(bool),
    /// A text, or the name of a choice.
    Text(String),
    /// A list.
    List(Vec<PlantValue>),
    /// A free table, which the bench passes on as it is.
    Table(BTreeMap<String, PlantValue>),
}

/// The values of a plant's keys, in the order of the model's keys.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlantValues(Vec<(&'static str, PlantValue)>);

impl PlantValues {
    /// Adds a key, or replaces its value.
    pub fn insert(&mut self, key: &'static str, value: PlantValue) {
        match self.0.iter_mut().find(|(name, _)| *name == key) {
            Some((_, old)) => *old = value,
            None => self.0.push((key, value)),
        }
    }

    /// The value of a key; `None` if the scenario's choices leave the key without one.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&PlantValue> {
        self.0.iter().find(|(name, _)| *name == key).map(|(_, value)| value)
    }

    /// The number of a key.
    ///
    /// # Errors
    /// The key has no number.
    pub fn number(&self, key: &'static str) -> Result<f64, PlantError> {
        match self.get(key) {
            Some(PlantValue::Number(number)) => Ok(*number),
            _ => Err(PlantError::NoValue { key, kind: "number" }),
        }
    }

    /// The whole number of a key.
    ///
    /// # Errors
    /// The key has no whole number, or one that `T` can't hold.
    pub fn integer<T: TryFrom<i64>>(&self, key: &'static str) -> Result<T, PlantError> {
        let integer = match self.get(key) {
            Some(PlantValue::Integer(integer)) => T::try_from(*integer).ok(),
            _ => None,
        };
        integer.ok_or(PlantError::NoValue { key, kind: "whole number" })
    }

    /// The text or the choice of a key.
    ///
    /// # Errors
    /// The key has no text.
    pub fn text(&self, key: &'static str) -> Result<&str, PlantError> {
        match self.get(key) {
            Some(PlantValue::Text(text)) => Ok(text),
            _ => Err(PlantError::NoValue { key, kind: "text" }),
        }
    }

    /// The texts of a list.
    ///
    /// # Errors
    /// The key has no list of texts.
    pub fn texts(&self, key: &'static str) -> Result<Vec<String>, PlantError> {
        let text =
            |value: &PlantValue| if let PlantValue::Text(text) = value { Some(text.clone()) } else { None };
        let texts = match self.get(key) {
            Some(PlantValue::List(items)) => items.iter().map(text).collect(),
            _ => None,
        };
        texts.ok_or(PlantError::NoValue { key, kind: "list of texts" })
    }

    /// The keys with their values, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &PlantValue)> {
        self.0.iter().map(|(name, value)| (*name, value))
    }

    /// Multiplies the number of a key; a key without a number stays as it is.
    pub fn scale(&mut self, key: &str, factor: f64) {
        let entry = self.0.iter_mut().find(|(name, _)| *name == key);
        if let Some((_, PlantValue::Number(number))) = entry {
            *number *= factor;
        }
    }
}

impl Serialize for PlantValues {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in self.iter() {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}
