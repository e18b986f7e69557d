//! One frame of a stream or of a capture, good or bad.

use lashloop_protocol::FrameError;
use lashloop_protocol::layout::{Direction, MessageLayout};

use super::value::Field;

/// Location of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Location {
    /// Offset of its first byte in the stream.
    Offset(u64),
    Packet {
        /// Of the packet, from 1.
        number: u64,
        /// Time since the first packet.
        time_ns: u64,
        /// As recorded in the capture, if it is.
        direction: Option<Direction>,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct DecodedMessage {
    pub layout: &'static MessageLayout,
    /// In the order of the bytes.
    pub fields: Vec<Field>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    pub location: Location,
    /// Bytes of the frame. On a line without delimiters, the last few thousand.
    pub bytes: Vec<u8>,
    pub message: Result<DecodedMessage, FrameError>,
}

impl Entry {
    /// By the kind of the message; for a bad frame, by the capture.
    #[must_use]
    pub fn direction(&self) -> Option<Direction> {
        match (&self.message, self.location) {
            (Ok(message), _) => Some(message.layout.direction),
            (Err(_), Location::Packet { direction, .. }) => direction,
            (Err(_), Location::Offset(_)) => None,
        }
    }
}
