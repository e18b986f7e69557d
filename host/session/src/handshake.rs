//! The handshake: `Hello` until the drive's `Identity` for this session.

use std::time::Duration;

use lashloop_protocol::message::{Hello, Identity};
use lashloop_protocol::{DriveMessage, Numbered, PROTOCOL_VERSION};

use crate::error::SessionError;
use crate::line::Line;

/// Time for all attempts. A drive may be booting or be reset by the opening of the port, and an emulator's terminal drops
/// the bytes of its first second.
const LIMIT: Duration = Duration::from_millis(2500);
/// Time between two attempts.
const INTERVAL: Duration = Duration::from_millis(100);

/// Repeats `Hello`, with one number, until the drive has sent its identity for `session`.
///
/// # Errors
/// The drive stays silent, has another protocol version, or the line broke.
pub fn shake_hands(line: &mut Line, session: u32) -> Result<Identity, SessionError> {
    let hello = Numbered { number: line.next_number(), message: Hello::new(session).into() };
    let mut left = line.patience.within(LIMIT);
    while !left.is_zero() {
        line.send_numbered(&hello)?;
        tracing::debug!(session, "Hello sent");
        let sent = line.now();
        let identity = line.wait_numbered(sent + INTERVAL, |answer| match answer.message {
            DriveMessage::Identity(identity) if identity.protocol_version != PROTOCOL_VERSION => {
                Some(Err(SessionError::Version { drive: identity.protocol_version }))
            }
            // The identity of another session answered an earlier host and is still on the line.
            DriveMessage::Identity(identity)
                if (answer.number, identity.session) == (hello.number, session) =>
            {
                Some(Ok(identity))
            }
            _ => None,
        })?;
        // A bench that stood still has not waited for the drive.
        let waited = line.now().saturating_duration_since(sent).min(INTERVAL);
        line.patience.spend(waited);
        left = left.saturating_sub(waited);
        if let Some(identity) = identity.transpose()? {
            line.session = session;
            return Ok(identity);
        }
    }
    Err(line.silent("Hello", LIMIT))
}
