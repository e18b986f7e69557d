//! What can go wrong in a conversation, in sentences that say which side and how far it got.

use std::fmt;
use std::time::Duration;

use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::sequence::nearest_step;
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, Message, PROTOCOL_VERSION};

use crate::link::LinkError;

/// How far the conversation had got.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LastSeen {
    /// Control period of the last sample sent, from 0 at the start; `None` before the first.
    pub sample_sent: Option<u32>,
    /// Name of the last good frame received.
    pub frame: Option<&'static str>,
    /// Control period of the latest torque received.
    pub torque: Option<u32>,
}

impl LastSeen {
    pub(super) fn note(&mut self, message: &DriveMessage) {
        self.frame = Some(message.layout().name);
        if let DriveMessage::TorqueAnswer(answer) = message
            && answer.status.state == State::Running
        {
            // A line that doubles answers or changes their order takes nothing back.
            self.torque = nearest_step(answer.sequence, self.sample_sent.unwrap_or(0)).max(self.torque);
        }
    }
}

impl fmt::Display for LastSeen {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.sample_sent {
            Some(step) => write!(out, "last sample sent: {step}, ")?,
            None => write!(out, "no sample sent yet, ")?,
        }
        match (self.frame, self.torque) {
            (None, _) => write!(out, "no good frame received"),
            (Some(frame), None) => write!(out, "last good frame received: {frame}"),
            (Some(frame), Some(torque)) => {
                write!(out, "last good frame received: {frame}, last torque for sample {torque}")
            }
        }
    }
}

/// What can go wrong in a conversation.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The line is gone.
    #[error("{source} ({last_seen})")]
    Broken {
        /// What the line said.
        source: LinkError,
        /// How far it had got.
        last_seen: LastSeen,
    },
    /// The drive did not answer in time.
    #[error("the drive was silent for {:.1} s after {waiting_for} ({last_seen})", limit.as_secs_f64())]
    Silent {
        /// What it should have answered.
        waiting_for: &'static str,
        /// How long it was waited for.
        limit: Duration,
        /// How far it had got.
        last_seen: LastSeen,
    },
    /// The drive has answered nothing for so many control periods that it takes no sample any more.
    #[error(
        "the drive has answered nothing for {periods} control periods and takes no sample after that ({last_seen})"
    )]
    TooLongAGap {
        /// Control periods since the last answer.
        periods: u32,
        /// How far it had got.
        last_seen: LastSeen,
    },
    /// The drive speaks another version of the protocol.
    #[error(
        "the drive speaks protocol version {drive}, this bench speaks version {}: flash the firmware that came with \
         this bench, or use the bench that came with that firmware",
        PROTOCOL_VERSION
    )]
    Version {
        /// Version of the drive.
        drive: u8,
    },
    /// The drive refused a request.
    #[error("the drive refused {request} in state {state:?}: {outcome:?}{} ({last_seen})", in_words(said))]
    Refused {
        /// The request.
        request: &'static str,
        /// Why.
        outcome: Outcome,
        /// In which state.
        state: State,
        /// What it said about it.
        said: String,
        /// How far the conversation had got.
        last_seen: LastSeen,
    },
}

fn in_words(said: &str) -> String {
    if said.is_empty() { String::new() } else { format!(", saying \"{said}\"") }
}

impl SessionError {
    /// Whether the drive is not there any more as it was: gone, silent, or started anew.
    #[must_use]
    pub fn is_loss(&self) -> bool {
        match self {
            Self::Broken { source, .. } => matches!(source, LinkError::Disconnected | LinkError::Stuck),
            Self::Silent { .. } | Self::TooLongAGap { .. } => true,
            Self::Refused { request, state, .. } => {
                *request == EncoderSample::LAYOUT.name && *state == State::Boot
            }
            _ => false,
        }
    }
}
