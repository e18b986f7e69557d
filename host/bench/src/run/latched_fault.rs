//! The report of a fault that the drive has latched.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::message::{FaultReport, GetParameter};

use crate::device::Device;
use lashloop_session::handshake::shake_hands;
use lashloop_session::{AtStep, SessionError};

/// Requests for the report of a latched fault, of which the line may lose some.
const FAULT_REQUESTS: usize = 3;

/// The fault of a drive that runs no more. Its report follows the last answer, or is lost on the line; the drive sends it
/// again after an identity. `None` if the drive has none.
pub(super) fn latched_fault(device: &mut Device) -> Result<Option<AtStep<FaultReport>>, SessionError> {
    let session = &mut device.session;
    for _ in 0..FAULT_REQUESTS {
        if session.line.fault.is_none() {
            let number = session.line.session;
            shake_hands(&mut session.line, number)?;
            // The report follows the identity; the answer to a request is behind both.
            let _ = session.line.request(&GetParameter { index: 0 }.into(), |answer| match answer {
                DriveMessage::ParameterReport(_) => Some(()),
                _ => None,
            })?;
        }
    }
    Ok(session.line.fault)
}
