//! The parameters in force of a record, set on a device.

use lashloop_bench::device::Device;
use lashloop_protocol::parameter_names::WATCHDOG_US;
use lashloop_session::{SetError, WrittenValue};
use serde::Deserialize;
use serde_json::Value;

use super::error::ReplayError;

/// The parameters in force of a record.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(transparent)]
pub struct RecordedParameters(Vec<RecordedParameter>);

#[derive(Debug, Clone, PartialEq, Deserialize)]
struct RecordedParameter {
    name: String,
    value: Value,
    /// Name of the value, for a parameter with choices. Another firmware may number them differently.
    #[serde(default)]
    choice: Option<String>,
    /// Whether the law in force has it. What only other laws have is of no effect.
    #[serde(default = "yes")]
    of_law: bool,
}

fn yes() -> bool {
    true
}

impl RecordedParameters {
    /// Those of a manifest that the law in force has; `None` if it has none.
    #[must_use]
    pub fn of(manifest: &Value) -> Option<Self> {
        let Self(mut parameters) = serde_json::from_value(manifest.get("parameters")?.clone()).ok()?;
        parameters.retain(|it| it.of_law);
        Some(Self(parameters))
    }

    /// Number of parameters.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Sets every parameter, in the order of the record. The watchdog counts time of the device, which is none of the run
    /// here: it waits for `watchdog_us`.
    ///
    /// # Errors
    /// The firmware lacks a parameter or a value, or the session failed.
    pub fn apply(&self, device: &mut Device, watchdog_us: f64) -> Result<(), ReplayError> {
        for RecordedParameter { name, value, choice, .. } in &self.0 {
            let written = match choice {
                _ if name == WATCHDOG_US => WrittenValue::Number(watchdog_us),
                Some(choice) => WrittenValue::Name(choice),
                None => WrittenValue::Number(value.as_f64().unwrap_or(f64::NAN)),
            };
            device.session.set(name, written).map_err(|error| {
                let is_known = device.session.parameter(name).is_some();
                let (name, value) = (name.clone(), choice.clone().unwrap_or_else(|| value.to_string()));
                let of = device.connection.choice.to_string();
                match error {
                    SetError::Session(source) => device.explain(source).into(),
                    error if is_known => {
                        ReplayError::Value { device: of, name, value, source: Box::new(error) }
                    }
                    error => ReplayError::Parameter { device: of, name, value, source: Box::new(error) },
                }
            })?;
        }
        Ok(())
    }
}
