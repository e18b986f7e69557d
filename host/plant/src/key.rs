//! Keys of a plant: what a scenario may give in `[plant]`, with unit, default, range and meaning.

use std::ops::RangeInclusive;

use crate::{ParameterError, PlantError, PlantValue};

/// Name of the key by which a plant asks the bench to delay its torques.
pub const TORQUE_DELAY_US: &str = "torque_delay_us";

/// A key of a plant. Its name ends with its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Name in the scenario.
    pub name: &'static str,
    /// Unit as an engineer writes it, such as `kg m^2`; empty for a pure number.
    pub unit: &'static str,
    /// One sentence for documents.
    pub meaning: &'static str,
    /// Type, range and default.
    pub kind: KeyKind,
    /// The key of a choice, and the name with which this key exists; `None` for a key that always exists.
    pub only_with: Option<(&'static str, &'static str)>,
    /// A key of a number below which this number may not be.
    pub at_least: Option<&'static str>,
}

/// Type, range and default of a key. A key without a default is required.
#[derive(Debug, Clone, PartialEq)]
pub enum KeyKind {
    /// A number.
    Number {
        /// Value of an absent key.
        default: Option<f64>,
        /// Allowed numbers.
        range: RangeInclusive<f64>,
    },
    /// A whole number.
    Integer {
        /// Value of an absent key.
        default: Option<u32>,
        /// Allowed numbers.
        range: RangeInclusive<u32>,
    },
    /// One of several names; the first is the default.
    Choice(&'static [&'static str]),
    /// Any text; empty if absent, unless it is required.
    Text {
        /// Whether a scenario must give it.
        is_required: bool,
    },
    /// A list of texts; empty if absent, unless it is required, with at least one.
    Texts {
        /// Whether a scenario must give it.
        is_required: bool,
    },
    /// A free table, which is passed on as it is; empty if absent.
    Table,
}

impl Key {
    fn new(name: &'static str, unit: &'static str, kind: KeyKind, meaning: &'static str) -> Self {
        Self { name, unit, meaning, kind, only_with: None, at_least: None }
    }

    /// A number; required if its default is `None`.
    #[must_use]
    pub fn number(
        name: &'static str,
        unit: &'static str,
        default: impl Into<Option<f64>>,
        range: RangeInclusive<f64>,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, unit, KeyKind::Number { default: default.into(), range }, meaning)
    }

    /// A whole number; required if its default is `None`.
    #[must_use]
    pub fn integer(
        name: &'static str,
        unit: &'static str,
        default: impl Into<Option<u32>>,
        range: RangeInclusive<u32>,
        meaning: &'static str,
    ) -> Self {
        Self::new(name, unit, KeyKind::Integer { default: default.into(), range }, meaning)
    }

    /// One of several names; the first is the default.
    #[must_use]
    pub fn choice(name: &'static str, names: &'static [&'static str], meaning: &'static str) -> Self {
        Self::new(name, "", KeyKind::Choice(names), meaning)
    }

    /// A text, empty if absent.
    #[must_use]
    pub fn text(name: &'static str, meaning: &'static str) -> Self {
        Self::new(name, "", KeyKind::Text { is_required: false }, meaning)
    }

    /// A required text.
    #[must_use]
    pub fn required_text(name: &'static str, meaning: &'static str) -> Self {
        Self::new(name, "", KeyKind::Text { is_required: true }, meaning)
    }

    /// A required list of texts.
    #[must_use]
    pub fn texts(name: &'static str, meaning: &'static str) -> Self {
        Self::new(name, "", KeyKind::Texts { is_required: true }, meaning)
    }

    /// A list of texts, empty if absent.
    #[must_use]
    pub fn optional_texts(name: &'static str, meaning: &'static str) -> Self {
        Self::new(name, "", KeyKind::Texts { is_required: false }, meaning)
    }

    /// A free table.
    #[must_use]
    pub fn table(name: &'static str, meaning: &'static str) -> Self {
        Self::new(name, "", KeyKind::Table, meaning)
    }

    /// The key `torque_delay_us`, in which a plant declares that torques reach its motor late. The bench delays them: the
    /// plant takes each torque when it arrives.
    #[must_use]
    pub fn torque_delay(default_us: u32) -> Self {
        let meaning = "Delay from a sample to its torque at the motor.";
        Self::integer(TORQUE_DELAY_US, "us", default_us, 0..=1_000_000, meaning)
    }

    /// The same key, which exists with one name of a choice only.
    #[must_use]
    pub fn only_with(self, choice: &'static str, name: &'static str) -> Self {
        Self { only_with: Some((choice, name)), ..self }
    }

    /// The same key with a number not below that of another key.
    #[must_use]
    pub fn at_least(self, other: &'static str) -> Self {
        Self { at_least: Some(other), ..self }
    }

    /// The value of an absent key; `None` if the key is required.
    #[must_use]
    pub fn default_value(&self) -> Option<PlantValue> {
        match &self.kind {
            KeyKind::Number { default, .. } => default.map(PlantValue::Number),
            KeyKind::Integer { default, .. } => default.map(|number| PlantValue::Integer(number.into())),
            KeyKind::Choice(names) => names.first().map(|name| PlantValue::Text((*name).to_owned())),
            KeyKind::Text { is_required: false } => Some(PlantValue::Text(String::new())),
            KeyKind::Texts { is_required: false } => Some(PlantValue::List(Vec::new())),
            KeyKind::Text { .. } | KeyKind::Texts { .. } => None,
            KeyKind::Table => Some(PlantValue::Table(Default::default())),
        }
    }

    /// Checks a number of this key against its range. Other values pass: their types are checked when they are taken.
    pub(crate) fn check(&self, value: &PlantValue) -> Result<(), PlantError> {
        let (value, low, high) = match (&self.kind, value) {
            (KeyKind::Number { range, .. }, PlantValue::Number(value)) => {
                (*value, *range.start(), *range.end())
            }
            (KeyKind::Integer { range, .. }, PlantValue::Integer(value)) => {
                (*value as f64, f64::from(*range.start()), f64::from(*range.end()))
            }
            _ => return Ok(()),
        };
        if (low..=high).contains(&value) {
            Ok(())
        } else {
            Err(ParameterError { name: self.name, value, low, high }.into())
        }
    }
}
