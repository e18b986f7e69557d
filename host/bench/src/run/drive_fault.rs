//! The fault behind an answer of a drive that runs no more.

use lashloop_protocol::message::TorqueAnswer;

use super::error::RunError;
use super::outcome::End;
use crate::device::Device;

/// The fault that an answer shows by its state. The report follows the answer; the answer to a stop is behind it.
pub(super) fn drive_fault(device: &mut Device, answer: &TorqueAnswer) -> Result<End, RunError> {
    if device.session.fault().is_none() {
        let stopped = device.session.stop();
        stopped.map_err(|source| device.explain(source))?;
    }
    match device.session.fault() {
        Some(fault) => Ok(End::DriveFault(fault)),
        None => Err(device
            .unfit(format!("state {:?} in the middle of the run, without a fault", answer.status.state))
            .into()),
    }
}
