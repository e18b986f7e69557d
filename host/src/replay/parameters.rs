//! The parameters in force of a record, set on a device.

use std::time::Duration;

use lashloop_bench::device::Device;
use lashloop_protocol::parameter_names::WATCHDOG_US;
use lashloop_record::manifest::ParameterInForce;
use lashloop_session::{SetError, WrittenValue};

use super::error::ReplayError;

/// The parameters in force of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedParameters(Vec<ParameterInForce>);

impl RecordedParameters {
    /// Those that the law in force has: what only other laws have is of no effect.
    #[must_use]
    pub fn of(parameters: &[ParameterInForce]) -> Self {
        Self(parameters.iter().filter(|it| it.of_law).cloned().collect())
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
    /// here: it waits for `watchdog`.
    ///
    /// # Errors
    /// The firmware lacks a parameter or a value, or the session failed.
    pub fn apply(&self, device: &mut Device, watchdog: Duration) -> Result<(), ReplayError> {
        for ParameterInForce { name, value, choice, .. } in &self.0 {
            // Another firmware may number its choices differently.
            let written = match choice {
                _ if name == WATCHDOG_US => WrittenValue::Number(1e6 * watchdog.as_secs_f64()),
                Some(choice) => WrittenValue::Name(choice),
                None => WrittenValue::Number((*value).into()),
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
