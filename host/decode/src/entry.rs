//! One frame of a stream or of a capture, good or bad.

use lashloop_protocol::field_value::FieldValue;
use lashloop_protocol::layout::{Direction, FieldLayout, MessageLayout, has_number};
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{FrameError, Message, Numbered, frame};
use serde::Serialize;

use super::message::{AnyMessage, direction_of};
use super::subscription::Label;

/// Location of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Location {
    Stream {
        /// Of its first byte.
        offset: u64,
    },
    Packet {
        /// Of the packet, from 1.
        #[serde(rename = "packet")]
        number: u64,
        /// Time since the first packet.
        time_ns: u64,
        /// As recorded in the capture, if it is.
        #[serde(skip)]
        direction: Option<Direction>,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct DecodedMessage {
    pub layout: &'static MessageLayout,
    /// Of the request that this is or answers; `None` for a kind without a number.
    pub number: Option<u8>,
    /// Of the values of telemetry, in their order; empty for any other message, and if the stream lacks the subscription.
    pub labels: Vec<Label>,
    body: Vec<u8>,
}

impl DecodedMessage {
    pub(super) fn new(Numbered { number, message }: &Numbered<AnyMessage>, labels: Vec<Label>) -> Self {
        let layout = message.layout();
        let mut stuffed = message.numbered_frame(*number).to_vec();
        stuffed.pop();
        // This frame was just encoded, so it is good.
        let body = frame::open(&mut stuffed).map_or_else(|_| Vec::new(), <[u8]>::to_vec);
        Self { layout, number: layout.has_number().then_some(*number), labels, body }
    }

    /// In the order of the bytes.
    pub fn fields(&self) -> impl Iterator<Item = (&'static FieldLayout, FieldValue<'_>)> {
        self.layout.fields.iter().filter_map(|field| Some((field, field.value(&self.body)?)))
    }

    /// Telemetry values with their labels; none if the labels are unknown.
    pub fn signals(&self) -> impl Iterator<Item = (&Label, f32)> {
        let values = self.fields().find_map(|(_, value)| match value {
            FieldValue::Reals(values) => Some(values),
            _ => None,
        });
        let values = values.map_or_else(Vec::new, |values| values.as_slice().to_vec());
        self.labels.iter().zip(values)
    }
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
            (Err(FrameError::Body(BodyError::UnknownKind { kind, .. })), _) => Some(direction_of(*kind)),
            (Err(_), Location::Packet { direction, .. }) => direction,
            (Err(_), Location::Stream { .. }) => None,
        }
    }

    /// Kind and number of a whole frame that this version doesn't know.
    #[must_use]
    pub fn unknown(&self) -> Option<(u8, Option<u8>)> {
        match self.message {
            Err(FrameError::Body(BodyError::UnknownKind { kind, number })) => {
                Some((kind, has_number(kind).then_some(number)))
            }
            _ => None,
        }
    }
}
