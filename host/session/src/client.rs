//! The host's side of a session.

use std::collections::BTreeMap;
use std::time::Instant;

use lashloop_link::Link;
use lashloop_protocol::enums::ParameterValue;
use lashloop_protocol::message::Identity;

use crate::capture_request::CaptureRequest;
use crate::description::Description;
use crate::error::SessionError;
use crate::handshake::shake_hands;
use crate::laws::Law;
use crate::line::Line;
use crate::parameters::Parameter;
use crate::signals::{DriveSignal, Subscription};
use crate::timestamps::Timestamps;

/// Frames of a session, as the bench counts them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Frames sent.
    pub frames_sent: u64,
    /// Good frames received.
    pub frames_received: u64,
    /// Damaged frames received.
    pub damaged: u64,
    /// Answers that arrived after the deadline of their sample.
    pub late: u64,
}

/// An open session.
pub struct Session {
    /// The link with its messages.
    pub line: Line,
    pub(crate) number: u32,
    /// The drive's identity, from the latest handshake.
    pub identity: Identity,
    /// The drive's laws, in the order of their index.
    pub laws: Vec<Law>,
    /// The drive's parameters, in the order of their index.
    pub parameters: Vec<Parameter>,
    /// Whether this session has reset the drive.
    pub(crate) is_reset: bool,
    /// Values that were set since the last reset, by the index of the parameter.
    pub(crate) values_set: BTreeMap<u8, ParameterValue>,
    /// The drive's signals, in the order of their index.
    pub signals: Vec<DriveSignal>,
    pub(crate) subscription: Subscription,
    pub(crate) capture: Option<CaptureRequest>,
    /// Damaged frames received before the present run.
    pub(crate) damaged_before: u32,
    /// Answers after their deadline.
    pub(crate) late: u64,
    /// Sequence number of the sample answered last.
    pub(crate) answered: Option<u16>,
    /// The timestamps of the latest exchange.
    pub timestamps: Timestamps,
}

impl Session {
    /// Opens a session on a fresh link: clears the line, shakes hands, reads what the drive describes. `number` distinguishes this
    /// session from earlier ones.
    ///
    /// # Errors
    /// The drive is silent, has another protocol version, or the line broke.
    pub fn open(link: Box<dyn Link>, number: u32) -> Result<Self, SessionError> {
        let mut line = Line::new(link);
        line.clear()?;
        let identity = shake_hands(&mut line, number)?;
        let Description { laws, parameters, signals } = Description::read(&mut line, &identity)?;
        tracing::info!(
            session = number,
            board = identity.board.as_str(),
            firmware = %identity.firmware,
            laws = laws.len(),
            parameters = parameters.len(),
            signals = signals.len(),
            "the drive completed the handshake"
        );
        let now = Instant::now();
        let timestamps = Timestamps { asked: now, sent: now, arrived: now, decoded: now };
        let subscription = Subscription::default();
        Ok(Self {
            line,
            number,
            identity,
            laws,
            parameters,
            is_reset: false,
            values_set: BTreeMap::new(),
            signals,
            subscription,
            capture: None,
            damaged_before: 0,
            late: 0,
            answered: None,
            timestamps,
        })
    }

    /// The telemetry that the drive sends.
    #[must_use]
    pub fn subscription(&self) -> &Subscription {
        &self.subscription
    }

    /// What is missing of the telemetry of the present run, as a sentence; `None` if damaged frames explain it.
    #[must_use]
    pub fn telemetry_warning(&self) -> Option<String> {
        let damaged = self.line.decoder.counters().damaged() - self.damaged_before;
        self.line.telemetry_count.warning(damaged.into())
    }

    /// The frame counts.
    #[must_use]
    pub fn traffic(&self) -> Traffic {
        let counters = self.line.decoder.counters();
        Traffic {
            frames_sent: self.line.frames_sent,
            frames_received: counters.messages.into(),
            damaged: counters.damaged().into(),
            late: self.late,
        }
    }
}
