//! One frame of a stream or of a capture, good or bad.

use lashloop_protocol::FrameError;
use lashloop_protocol::layout::{Direction, MessageLayout};

use super::value::Field;

/// Where a frame was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Location {
    /// Offset of its first byte in the stream.
    Offset(u64),
    /// In a capture.
    Packet {
        /// Number of the packet, from 1.
        number: u64,
        /// Time since the first packet.
        time_ns: u64,
        /// Who sent it, if the capture says so.
        direction: Option<Direction>,
    },
}

/// A message that was found whole.
#[derive(Debug, Clone, PartialEq)]
pub struct DecodedMessage {
    /// What kind it is.
    pub layout: &'static MessageLayout,
    /// What it says, in the order of its bytes.
    pub fields: Vec<Field>,
}

/// One frame, good or bad.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Where it was.
    pub location: Location,
    /// Its bytes, as far as they were kept: of a line without delimiters the last few thousand.
    pub bytes: Vec<u8>,
    /// What it says, or why it says nothing.
    pub message: Result<DecodedMessage, FrameError>,
}

impl Entry {
    /// Who sent it: by its kind, or for a bad frame by the capture.
    #[must_use]
    pub fn direction(&self) -> Option<Direction> {
        match (&self.message, self.location) {
            (Ok(message), _) => Some(message.layout.direction),
            (Err(_), Location::Packet { direction, .. }) => direction,
            (Err(_), Location::Offset(_)) => None,
        }
    }
}
