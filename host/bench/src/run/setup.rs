//! Applies the scenario's settings to the drive.
//!
//! The drive is reset first, because it keeps the settings of the last host: a run depends on its scenario alone.

use std::time::Duration;

use lashloop_protocol::enums::{ControllerId, DisturbingTorqueSource, Outcome, ParameterValue};
use lashloop_protocol::message::Identity;

use super::error::RunError;
use crate::device::{Device, DeviceError};
use crate::scenario::controller::{self, ParameterSetting};
use crate::scenario::{Scenario, ScenarioError};
use crate::session::{SessionError, SetError};
use crate::timing::ClockName;

/// Parameters that keys outside `[controller.parameters]` set: name, key and value.
fn from_sections(scenario: &Scenario) -> [(&'static str, &'static str, f64); 5] {
    let Scenario { controller, run, encoders, telemetry, .. } = scenario;
    [
        ("controller", "controller.name", f64::from(controller.name as u8)),
        ("period_us", "run.control_period_us", run.control_period_us.into()),
        ("motor_counts_per_rev", "encoders.motor_counts_per_rev", encoders.motor_counts_per_rev.into()),
        ("load_counts_per_rev", "encoders.load_counts_per_rev", encoders.load_counts_per_rev.into()),
        ("telemetry_every", "telemetry.every_steps", telemetry.every_steps.into()),
    ]
}

/// Resets the drive and applies all settings of the scenario.
///
/// # Errors
/// The drive does not offer the control law or does not take a parameter, with the place in the scenario; or the session
/// failed.
pub fn set_up(device: &mut Device, scenario: &Scenario, clock: ClockName) -> Result<(), RunError> {
    device.session.reset().map_err(|source| device.explain(source))?;
    configure(device, scenario, clock)
}

/// Applies all settings to a drive that was just reset.
fn configure(device: &mut Device, scenario: &Scenario, clock: ClockName) -> Result<(), RunError> {
    let controller = scenario.controller.name;
    // Setting the parameter would fail too, but with a number instead of a name.
    if !device.session.identity.controllers.offers(controller) {
        return Err(not_offered(device, scenario.controller.name).into());
    }
    let from_sections = from_sections(scenario);
    for (name, _, number) in from_sections {
        set_required(device, name, number)?;
    }
    if clock == ClockName::Lockstep {
        // The watchdog must tolerate a slow bench but not a dead one: it waits as long for the bench as the bench does for
        // the drive. In real time it stays as on a real bench.
        set_required(device, "watchdog_us", 1e3 * f64::from(scenario.link.silence_limit_ms))?;
    }
    for setting in &scenario.controller.parameters {
        if let Some((_, key, _)) = from_sections.iter().find(|(name, ..)| *name == setting.name) {
            return Err(ScenarioError::parameter(setting, format!("is set by {key}; set it there")).into());
        }
        apply(device, setting)?;
    }
    Ok(())
}

/// Reads how long the drive gives torque without a new sample.
///
/// # Errors
/// The drive has no such parameter, or the session failed.
pub(super) fn watchdog(device: &mut Device) -> Result<Duration, RunError> {
    let Some(index) = device.session.parameter("watchdog_us").map(|parameter| parameter.index) else {
        return Err(device
            .unfit("it has no parameter watchdog_us, which every drive must have".to_owned())
            .into());
    };
    match device.session.get(index).map_err(|source| device.explain(source))? {
        ParameterValue::U32(us) => Ok(Duration::from_micros(us.into())),
        ParameterValue::F32(us) => Duration::try_from_secs_f32(1e-6 * us)
            .map_err(|error| device.unfit(format!("its watchdog_us is {us}: {error}")).into()),
    }
}

/// Sets up a drive that was lost, up to its start. It must be the same firmware: parameters are set by the indices read from
/// it, and a run has one drive.
pub(super) fn resume(
    device: &mut Device,
    scenario: &Scenario,
    clock: ClockName,
    lost: &Identity,
) -> Result<(), RunError> {
    device.session.line.clear().map_err(|source| device.explain(source))?;
    device.session.reset().map_err(|source| device.explain(source))?;
    let firmware_of = |it: &Identity| (it.board, it.firmware, it.build_id, it.parameter_count);
    if firmware_of(&device.session.identity) != firmware_of(lost) {
        let build = lost.build_id;
        return Err(device
            .unfit(format!("it came back with another firmware than build {build:08x}"))
            .into());
    }
    configure(device, scenario, clock)
}

/// The error for a drive that does not start. Parameters that contradict each other are the scenario's error.
pub(super) fn refused_start(device: &Device, source: SessionError) -> RunError {
    match source {
        SessionError::Refused { outcome: Outcome::Inconsistent, log, .. } => RunError::Inconsistent { log },
        source => device.explain(source).into(),
    }
}

fn not_offered(device: &Device, wanted: ControllerId) -> DeviceError {
    let offered = device.session.identity.controllers;
    let mut laws: Vec<_> =
        ControllerId::ALL.iter().filter(|law| offered.offers(**law)).map(|law| law.name()).collect();
    if laws.is_empty() {
        laws.push("none that a scenario can name");
    }
    let laws = laws.join(", ");
    device.unfit(format!(
        "it does not offer the control law {wanted}, which the scenario needs; it offers {laws}"
    ))
}

fn apply(device: &mut Device, setting: &ParameterSetting) -> Result<(), RunError> {
    let number = number_of(setting)?;
    device.session.set(&setting.name, number).map_err(|error| match error {
        SetError::Session(source) => device.explain(source).into(),
        refused => RunError::from(ScenarioError::parameter(setting, format!("is refused: {refused}"))),
    })
}

fn number_of(setting: &ParameterSetting) -> Result<f64, ScenarioError> {
    match (&setting.value, setting.name.as_str()) {
        (controller::ParameterValue::Number(number), _) => Ok(*number),
        (controller::ParameterValue::Boolean(on), _) => Ok(f64::from(u8::from(*on))),
        (controller::ParameterValue::Text(text), "disturbing_torque_source") => match text.as_str() {
            "model" => Ok(f64::from(DisturbingTorqueSource::Model as u8)),
            "observed" => Ok(f64::from(DisturbingTorqueSource::Observed as u8)),
            _ => Err(ScenarioError::parameter(setting, "is no source; it must be \"model\" or \"observed\"")),
        },
        (controller::ParameterValue::Text(_), _) => {
            Err(ScenarioError::parameter(setting, "is a text; the drive takes a number"))
        }
    }
}

/// Sets a parameter that every drive must have.
fn set_required(device: &mut Device, name: &str, number: f64) -> Result<(), DeviceError> {
    device.session.set(name, number).map_err(|error| match error {
        SetError::Session(source) => device.explain(source),
        refused => {
            device.unfit(format!("it does not take {name} = {number}, which the scenario needs: {refused}"))
        }
    })
}
