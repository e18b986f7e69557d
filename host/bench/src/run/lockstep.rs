//! Lockstep: the plant waits for the drive, the drive waits for the plant, and no clock paces them.
//!
//! So a run is the same bit for bit on every link and on a busy machine, and as fast as the link allows.

use std::time::Duration;

use super::error::RunError;
use super::outcome::End;
use super::run_loop::RunLoop;
use super::step_sink::StepSink;
use crate::device::Device;
use crate::scenario::Scenario;

/// Closes the loop for the duration of the scenario.
///
/// # Errors
/// The device, its link or the record failed.
pub(super) fn close<S: StepSink>(
    control: &mut RunLoop<'_, S>,
    scenario: &Scenario,
    device: &mut Device,
) -> Result<End, RunError> {
    let answer_timeout = scenario.link.answer_timeout();
    for step in 0..control.periods() {
        if control.state().sink.stop_asked() {
            return Ok(End::Interrupted);
        }
        let deadline = device.session.line.now() + answer_timeout;
        if let Some(end) = control.step(step, deadline, Duration::ZERO, device)? {
            return Ok(end);
        }
    }
    control.complete(device)
}
