//! The parameters in force of a record, set on a device.

use std::time::Duration;

use lashloop_bench::device::Device;
use lashloop_protocol::parameter_names::WATCHDOG_US;
use lashloop_record::manifest::ParameterInForce;
use lashloop_session::{SetError, WrittenValue};

use super::error::ReplayError;

/// Sets the parameters that the law in force has, in the order of the record: parameters of other laws have no effect.
/// The watchdog counts the time of the device and not that of the run: it waits for `watchdog`.
///
/// # Errors
/// The firmware lacks a parameter or a value, or the session failed.
pub(super) fn apply(
    parameters: &[ParameterInForce],
    device: &mut Device,
    watchdog: Duration,
) -> Result<(), ReplayError> {
    for ParameterInForce { name, value, choice, .. } in parameters.iter().filter(|it| it.of_law) {
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
                error if is_known => ReplayError::Value { device: of, name, value, source: Box::new(error) },
                error => ReplayError::Parameter { device: of, name, value, source: Box::new(error) },
            }
        })?;
    }
    Ok(())
}
