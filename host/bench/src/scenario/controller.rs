//! `[controller]`: the drive's control law and parameters.

use std::fmt;

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use super::declare::{Field, section_of, skipped, text};
use super::error::ScenarioError;
use super::key::Further;
use super::key_error::KeyError;
use super::origin::Origin;
use super::spelling::{spell_key, spell_text};
use super::tree::{Node, Value};
use crate::settings;

settings! {
    /// The law, and the parameters set on the drive before the run. A law that the drive doesn't describe is reported at
    /// connection.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct ControllerSettings {
        /// The control law, by its name in the drive; `lashloop parameters list` prints the laws.
        pub name: String = text("the name of one of the drive's laws, in quotes"),
        /// Where the law is named.
        #[serde(skip)]
        pub origin: Origin = skipped(|controller| controller.origin_of("name")),
        /// Parameters set on the drive before the run, by their names in the drive; `lashloop parameters list` prints them
        /// with unit, range and default.
        #[serde(serialize_with = "serialize_parameters")]
        pub parameters: Vec<ParameterSetting> = parameters(),
    }
}

/// A parameter of the drive. Names, types and ranges come from the drive's self-description at connection; errors are
/// reported then, by [`ScenarioError::parameter`].
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSetting {
    /// Its section, such as `controller.parameters`.
    pub section: &'static str,
    /// Name of the parameter.
    pub name: String,
    /// Its value.
    pub value: ParameterValue,
    /// Where it is written.
    pub origin: Origin,
}

impl ScenarioError {
    /// The error for a value of `key` that the drive has nothing for, which shows only after connecting. `reason` continues
    /// the sentence after `found`, the value as written.
    #[must_use]
    pub fn by_drive(origin: &Origin, key: &str, found: String, reason: impl fmt::Display) -> Self {
        Self::rejected(origin, key, found, format!("is refused: {reason}"))
    }

    /// The error for a parameter that the drive rejects, which shows only after connecting, because the drive describes its
    /// parameters itself. `reason` continues the sentence after the value, for instance
    /// `is out of range; it must be >= 0 and <= 50 N m`.
    #[must_use]
    pub fn parameter(setting: &ParameterSetting, reason: impl Into<String>) -> Self {
        let key = format!("{}.{}", setting.section, spell_key(&setting.name));
        Self::rejected(&setting.origin, key, &setting.value, reason)
    }
}

/// The value of a drive parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ParameterValue {
    /// A finite number.
    Number(f64),
    /// On or off.
    Boolean(bool),
    /// A text.
    Text(String),
}

impl fmt::Display for ParameterValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Boolean(boolean) => write!(f, "{boolean}"),
            Self::Text(text) => f.write_str(&spell_text(text)),
        }
    }
}

/// `[controller.parameters]`, in the order of the file.
fn parameters() -> impl Field<Value = Vec<ParameterSetting>> {
    section_of(|parameters| {
        parameters.describe(|keys| keys.further = Further::Values);
        let setting = |(name, node): (&str, &Node)| match read_value(node) {
            Ok(value) => {
                let (name, origin) = (name.to_owned(), node.origin.clone());
                Some(ParameterSetting { section: "controller.parameters", name, value, origin })
            }
            Err(error) => {
                parameters.error(&spell_key(name), node, error);
                None
            }
        };
        parameters.all().filter_map(setting).collect()
    })
}

fn read_value(node: &Node) -> Result<ParameterValue, KeyError> {
    match &node.value {
        // Exact up to 2^53; drives compute in f32.
        Value::Integer(number) => Ok(ParameterValue::Number(*number as f64)),
        Value::Float(number) if number.is_finite() => Ok(ParameterValue::Number(*number)),
        Value::Float(_) => {
            Err(KeyError::OutOfRange { found: node.value.to_string(), allowed: "a finite number".to_owned() })
        }
        Value::Boolean(boolean) => Ok(ParameterValue::Boolean(*boolean)),
        Value::Text(text) => Ok(ParameterValue::Text(text.clone())),
        Value::Date(_) | Value::Array(_) | Value::Table(_) => Err(KeyError::WrongType {
            found: node.value.to_string(),
            kind: node.value.kind(),
            allowed: "a number, a boolean or a text".to_owned(),
        }),
    }
}

pub(super) fn serialize_parameters<S: Serializer>(
    settings: &[ParameterSetting],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(settings.len()))?;
    for setting in settings {
        map.serialize_entry(&setting.name, &setting.value)?;
    }
    map.end()
}
