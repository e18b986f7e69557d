//! The handshake: `Hello` until the drive's `Identity` for this session.

use std::time::Duration;

use lashloop_protocol::message::{Hello, Identity};
use lashloop_protocol::{DriveMessage, PROTOCOL_VERSION};

use crate::error::SessionError;
use crate::line::Line;

/// Time for all attempts. A drive may be booting or be reset by the opening of the port, and an emulator's terminal drops
/// the bytes of its first second.
const LIMIT: Duration = Duration::from_millis(2500);
/// Time between two attempts.
const INTERVAL: Duration = Duration::from_millis(100);

/// Repeats `Hello` until the drive has sent its identity for `session`.
///
/// # Errors
/// The drive stays silent, has another protocol version, or the line broke.
pub fn shake_hands(line: &mut Line, session: u32) -> Result<Identity, SessionError> {
    let hello = Hello { protocol_version: PROTOCOL_VERSION, session };
    let began = line.now();
    let give_up = began + line.patience.within(LIMIT);
    while line.now() < give_up {
        line.send(&hello.into())?;
        let deadline = line.now() + INTERVAL;
        let identity = line.wait(deadline, |message| match message {
            DriveMessage::Identity(identity) if identity.protocol_version != PROTOCOL_VERSION => {
                Some(Err(SessionError::Version { drive: identity.protocol_version }))
            }
            // The identity of another session answered an earlier host and is still on the line.
            DriveMessage::Identity(identity) if identity.session == session => Some(Ok(*identity)),
            _ => None,
        })?;
        if let Some(identity) = identity.transpose()? {
            line.session = session;
            let waited = line.now().saturating_duration_since(began);
            line.patience.spend(waited);
            return Ok(identity);
        }
    }
    let waited = line.now().saturating_duration_since(began);
    line.patience.spend(waited);
    Err(line.silent("Hello", LIMIT))
}
