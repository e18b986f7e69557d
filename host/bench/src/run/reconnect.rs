//! Getting a lost drive back: set up again at once, started again in the step that sends its first sample.

use std::ops::ControlFlow;
use std::thread;
use std::time::Duration;

use lashloop_protocol::enums::State;

use super::error::RunError;
use super::outcome::End;
use super::setup;
use crate::device::Device;
use crate::fault::timeline::Timeline;
use crate::scenario::Scenario;
use crate::scenario::sections::OnLoss;
use crate::timing::ClockName;
use lashloop_session::SessionError;

/// Time between two attempts.
const INTERVAL: Duration = Duration::from_millis(50);

/// Time that a start may take in real time: less than the timeout of a lost answer.
const START_LIMIT: Duration = Duration::from_millis(250);

/// How a run ends with the loss of its drive if the scenario does not ask for it back.
pub(super) fn end_of_loss(
    source: SessionError,
    scenario: &Scenario,
    device: &Device,
) -> Option<Result<End, RunError>> {
    match (scenario.link.on_loss, source) {
        (OnLoss::Resume, _) => None,
        (OnLoss::End, SessionError::Refused { state: State::Boot, .. }) => Some(Ok(End::DriveRestarted)),
        (OnLoss::End, source) => Some(Err(device.explain(source).into())),
    }
}

/// Sets a lost drive up again, with retries for as long as the scenario allows. Continues with its largest torque in
/// N m; breaks with the end of the run if the user stops it.
///
/// # Errors
/// The drive did not come back in time, or another firmware did.
pub(super) fn set_up_again(
    scenario: &Scenario,
    clock: ClockName,
    timeline: &mut Timeline,
    device: &mut Device,
    stop_asked: impl Fn() -> bool,
) -> Result<ControlFlow<End, f32>, RunError> {
    let deadline = device.session.line.now() + scenario.link.resume_limit();
    let lost = device.session.identity;
    tracing::info!("the drive is lost: the bench sets it up again");
    loop {
        timeline.revive(device);
        let error = match setup::resume(device, scenario, clock, &lost) {
            Ok(torque_limit_nm) => return Ok(ControlFlow::Continue(torque_limit_nm)),
            Err(error) => error,
        };
        tracing::debug!(%error, "the drive is not there yet");
        if stop_asked() {
            return Ok(ControlFlow::Break(End::Interrupted));
        }
        let is_transient = matches!(&error, RunError::Device(error) if error.is_transient());
        let now = device.session.line.now();
        if !is_transient || now >= deadline {
            return Err(error);
        }
        if device.session.line.wait_until(now + INTERVAL).is_err() {
            // A broken line does not wait.
            thread::sleep(INTERVAL);
        }
    }
}

/// Starts a drive that was set up again, and returns whether it runs. Not before the step that sends the first sample: the
/// watchdog runs from the start on, and in real time the plant must first catch up with the steps that were missed. A start
/// that took so long that many more were missed is taken back, and the next step repeats it.
///
/// # Errors
/// The drive rejected the start or is silent, or the line broke.
pub(super) fn start_again(clock: ClockName, device: &mut Device) -> Result<bool, SessionError> {
    let began = device.session.line.now();
    device.session.start()?;
    let is_late = clock == ClockName::RealTime && device.session.line.now() - began > START_LIMIT;
    if is_late {
        device.session.disarm()?;
    }
    Ok(!is_late)
}
