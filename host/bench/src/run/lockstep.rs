//! Lockstep: the plant waits for the drive, the drive waits for the plant, and no clock has a say.
//!
//! So a run is the same bit for bit whatever carries the bytes and however busy the machine is, and as fast as the link
//! allows.

use std::time::{Duration, Instant};

use super::control_loop::{ControlLoop, Sink};
use super::{End, RunError};
use crate::device::Device;
use crate::scenario::Scenario;

/// Closes the loop for the duration of the scenario.
///
/// # Errors
/// Device, link or record failed.
pub(super) fn close<S: Sink>(
    control: &mut ControlLoop<'_, S>,
    scenario: &Scenario,
    device: &mut Device,
) -> Result<End, RunError> {
    let answer_timeout = scenario.link.answer_timeout();
    for sequence in 0..scenario.run.steps() {
        if control.stop_asked() {
            return Ok(End::Interrupted);
        }
        match control.step(sequence, Instant::now() + answer_timeout, Duration::ZERO, device) {
            Ok(None) => {}
            Ok(Some(end)) => return Ok(end),
            Err(error) => return error.end(),
        }
    }
    Ok(End::Complete)
}
