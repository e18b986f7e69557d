//! Applies the scenario's settings to the drive.
//!
//! The drive is reset first, because it keeps the settings of the last host: a run depends on its scenario alone.

use std::time::Duration;

use lashloop_plant::Signal;
use lashloop_protocol::enums::{Outcome, ParameterValue};
use lashloop_protocol::message::Identity;
use lashloop_protocol::parameter_names::{TORQUE_LIMIT_NM, WATCHDOG_US};

use super::drive_settings::{DriveSettings, written};
use super::error::RunError;
use crate::device::{Device, DeviceError, DriveHost};
use crate::scenario::{RunMode, Scenario, ScenarioError};
use crate::timing::ClockName;
use lashloop_session::{CaptureError, SessionError, SetError, SubscribeError};

/// Time for the first reading after power-up: two of the longest control periods, of 100 ms.
const FIRST_READING_LIMIT: Duration = Duration::from_millis(200);
/// Time for which a busy machine may stop the bench. Every drive takes it as its watchdog.
const LONGEST_STALL: Duration = Duration::from_secs(30);
/// Detail of `EncoderImplausible`: the encoders were not read since power-up.
const NOT_READ: u32 = 1;
/// Time between two attempts.
const FIRST_READING_INTERVAL: Duration = Duration::from_millis(10);

/// Resets the drive and applies all settings of the scenario. Returns the signals that its telemetry carries.
///
/// # Errors
/// The drive lacks the control law, a parameter or a signal, with the place in the scenario; or the session failed.
pub fn set_up(device: &mut Device, scenario: &Scenario, clock: ClockName) -> Result<Vec<Signal>, RunError> {
    device.session.reset().map_err(|source| device.explain(source))?;
    configure(device, scenario, clock)?;
    let subscribed = device.session.subscription().signals();
    Ok(subscribed.iter().map(|it| it.signal.clone()).collect())
}

/// The drive's watchdog in lockstep: it must tolerate a slow bench but not a dead one, so it waits as long for the bench as the
/// bench does for the drive. A drive that the bench has started also tolerates a bench that stands still.
pub fn lockstep_watchdog(host: &DriveHost, silence_limit: Duration) -> Duration {
    if host.is_started() { silence_limit.max(LONGEST_STALL) } else { silence_limit }
}

/// Applies all settings to a drive that was just reset.
fn configure(device: &mut Device, scenario: &Scenario, clock: ClockName) -> Result<(), RunError> {
    // In real time the watchdog stays as on a real bench.
    let watchdog = (clock == ClockName::Lockstep)
        .then(|| lockstep_watchdog(&device.connection.host, scenario.link.silence_limit()));
    let settings = DriveSettings::new(scenario, &device.session, watchdog)?;
    for (name, number) in settings.required {
        set_required(device, name, number)?;
    }
    for setting in settings.parameters {
        device.session.set(&setting.name, written(&setting.value)).map_err(|error| match error {
            SetError::Session(source) => device.explain(source).into(),
            refused => RunError::from(ScenarioError::parameter(setting, format!("is refused: {refused}"))),
        })?;
    }
    device.session.subscribe(settings.subscription).map_err(|error| match error {
        SubscribeError::Session(source) => device.explain(source),
        rejected @ SubscribeError::Rejected { .. } => {
            device.unfit(format!("it does not send the signals that the scenario needs: {rejected}"))
        }
    })?;
    if let (Some(capture), Some(first)) = (settings.capture, scenario.scope.first()) {
        device.session.capture(capture).map_err(|error| match error {
            CaptureError::Session(source) => device.explain(source).into(),
            refused => {
                let rows = scenario.scope.before_rows.to_string();
                let reason = format!("{refused}; its memory takes more rows of fewer signals");
                RunError::from(ScenarioError::by_drive(&first.origin, "scope.before_rows", rows, reason))
            }
        })?;
    }
    for note in settings.notes {
        device.session.line.logs.note(note);
    }
    Ok(())
}

/// Reads how long the drive gives torque without a new sample.
///
/// # Errors
/// The drive has no such parameter, or the session failed.
pub(super) fn watchdog(device: &mut Device) -> Result<Duration, RunError> {
    match in_force(device, WATCHDOG_US)? {
        ParameterValue::U32(us) => Ok(Duration::from_micros(us.into())),
        ParameterValue::F32(us) => Duration::try_from_secs_f32(1e-6 * us)
            .map_err(|error| device.unfit(format!("its watchdog_us is {us}: {error}")).into()),
        unknown @ ParameterValue::Unknown { .. } => {
            Err(device.unfit(format!("its watchdog_us is {unknown} ({})", unknown.ty())).into())
        }
    }
}

/// Reads the largest torque of the drive in N m, in either direction.
///
/// # Errors
/// The drive has no such limit, or the session failed.
pub(super) fn torque_limit_nm(device: &mut Device) -> Result<f32, RunError> {
    match in_force(device, TORQUE_LIMIT_NM)? {
        ParameterValue::F32(limit_nm) if limit_nm >= 0.0 => Ok(limit_nm),
        other => Err(device
            .unfit(format!(
                "its {TORQUE_LIMIT_NM} is {other} ({}); it must be an F32 of 0 N m or more",
                other.ty()
            ))
            .into()),
    }
}

/// The value in force of a parameter that every drive must have.
fn in_force(device: &mut Device, name: &str) -> Result<ParameterValue, RunError> {
    let Some(index) = device.session.parameter(name).map(|parameter| parameter.index) else {
        return Err(device.unfit(format!("it has no parameter {name}, which every drive must have")).into());
    };
    Ok(device.session.get(index).map_err(|source| device.explain(source))?)
}

/// Sets up a drive that was lost, up to its start. It must be the same firmware: parameters are set by the indices read from
/// it, and a run has one drive. Returns its largest torque in N m.
pub(super) fn resume(
    device: &mut Device,
    scenario: &Scenario,
    clock: ClockName,
    lost: &Identity,
) -> Result<f32, RunError> {
    device.session.line.clear().map_err(|source| device.explain(source))?;
    device.session.reset().map_err(|source| device.explain(source))?;
    let firmware_of = |it: &Identity| {
        (it.board, it.firmware, it.build_id, it.dirty, it.law_count, it.parameter_count, it.signal_count)
    };
    if firmware_of(&device.session.identity) != firmware_of(lost) {
        let build = lost.build_id;
        return Err(device
            .unfit(format!("it came back with another firmware than build {build:08x}"))
            .into());
    }
    configure(device, scenario, clock)?;
    torque_limit_nm(device)
}

/// Starts the drive. In bench mode it needs a reading of its encoders, which comes with the first tick after power-up.
pub(super) fn start(device: &mut Device, mode: RunMode) -> Result<(), SessionError> {
    let give_up = device.session.line.now() + FIRST_READING_LIMIT;
    loop {
        match device.session.start() {
            Err(SessionError::Refused { outcome: Outcome::EncoderImplausible, detail: NOT_READ, .. })
                if mode == RunMode::Bench && device.session.line.now() < give_up =>
            {
                let next = device.session.line.now() + FIRST_READING_INTERVAL;
                device.session.line.wait_until(next)?;
            }
            started => return started,
        }
    }
}

/// The error for a drive that does not start. Parameters that contradict each other are the scenario's error.
pub(super) fn refused_start(device: &Device, source: SessionError) -> RunError {
    match source {
        SessionError::Refused { outcome: Outcome::Inconsistent, cause, .. } => {
            RunError::Inconsistent { cause }
        }
        source => device.explain(source).into(),
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

#[cfg(test)]
mod tests {
    use lashloop_link::in_process::Suspension;

    use super::*;

    #[test]
    fn only_a_drive_that_the_bench_has_started_waits_for_a_bench_that_stands_still() {
        let watchdog_s = |host: DriveHost, silence_limit_s| {
            lockstep_watchdog(&host, Duration::from_secs(silence_limit_s)).as_secs()
        };
        let started = || DriveHost::InProcess(Suspension::default());
        assert_eq!([2, 60].map(|limit_s| watchdog_s(DriveHost::External, limit_s)), [2, 60]);
        assert_eq!([2, 60].map(|limit_s| watchdog_s(started(), limit_s)), [30, 60]);
    }
}
