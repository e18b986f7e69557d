//! How a conversation begins.

use std::time::{Duration, Instant};

use lashloop_protocol::message::{Hello, Identity};
use lashloop_protocol::{DriveMessage, PROTOCOL_VERSION};

use super::SessionError;
use super::line::Line;

/// A drive may be starting, or be reset by the opening of the port; an emulator's terminal drops what comes in its first
/// second. So the greeting is repeated until it is answered or this has passed.
const LIMIT: Duration = Duration::from_millis(2500);
/// Time between two greetings.
const INTERVAL: Duration = Duration::from_millis(100);

/// Greets until the drive has answered this very session.
pub fn greet(line: &mut Line, session: u32) -> Result<Identity, SessionError> {
    let hello = Hello { protocol_version: PROTOCOL_VERSION, session };
    let give_up = Instant::now() + LIMIT;
    while Instant::now() < give_up {
        line.send(&hello.into())?;
        let identity = line.wait(Instant::now() + INTERVAL, |message| match message {
            DriveMessage::Identity(identity) if identity.protocol_version != PROTOCOL_VERSION => {
                Some(*identity)
            }
            // Another session's was said to an earlier host and is still on the line.
            DriveMessage::Identity(identity) if identity.session == session => Some(*identity),
            _ => None,
        })?;
        match identity {
            Some(identity) if identity.protocol_version == PROTOCOL_VERSION => {
                line.session = session;
                return Ok(identity);
            }
            Some(identity) => return Err(SessionError::Version { drive: identity.protocol_version }),
            None => {}
        }
    }
    Err(line.silent("Hello", LIMIT))
}
