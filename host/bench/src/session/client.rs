//! The host's side of a session.

use std::time::{Duration, Instant};

use lashloop_protocol::message::{EncoderSample, FaultReport, Identity, LineReport, Telemetry};
use lashloop_protocol::wire::Payload;

use super::at_step::AtStep;
use super::error::SessionError;
use super::handshake::shake_hands;
use super::line::Line;
use super::parameters::{self, Parameter};
use crate::link::{Link, TimeBase};
use crate::timing::Timestamps;

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
    pub(super) line: Line,
    pub(super) number: u32,
    pub(super) identity: Identity,
    pub(super) parameters: Vec<Parameter>,
    /// Answers after their deadline.
    pub(super) late: u64,
    /// Sequence number of the sample answered last.
    pub(super) answered: Option<u16>,
    pub(super) timestamps: Timestamps,
}

impl Session {
    /// Opens a session on a fresh link: clears the line, shakes hands, reads the parameters. `number` distinguishes this
    /// session from earlier ones.
    ///
    /// # Errors
    /// The drive is silent, has another protocol version, or the line broke.
    pub fn open(link: Box<dyn Link>, number: u32) -> Result<Self, SessionError> {
        let mut line = Line::new(link);
        line.clear()?;
        let identity = shake_hands(&mut line, number)?;
        let parameters = parameters::read_all(&mut line, identity.parameter_count)?;
        let now = Instant::now();
        let timestamps = Timestamps { asked: now, sent: now, arrived: now, decoded: now };
        Ok(Self { line, number, identity, parameters, late: 0, answered: None, timestamps })
    }

    /// The drive's identity, from the latest handshake.
    #[must_use]
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The last telemetry since the start.
    #[must_use]
    pub fn telemetry(&self) -> Option<&AtStep<Telemetry>> {
        self.line.telemetry.as_ref()
    }

    /// The last fault the drive reported since the start.
    #[must_use]
    pub fn fault(&self) -> Option<AtStep<FaultReport>> {
        self.line.fault
    }

    /// The drive's counts of the last run; `None` before the stop.
    #[must_use]
    pub fn line_report(&self) -> Option<&LineReport> {
        self.line.report.as_ref()
    }

    /// Removes and returns the drive's log texts.
    pub fn take_logs(&mut self) -> Vec<String> {
        self.line.logs.take()
    }

    /// The frame counts.
    #[must_use]
    pub fn traffic(&self) -> Traffic {
        let counters = self.line.decoder().counters();
        Traffic {
            frames_sent: self.line.frames_sent,
            frames_received: counters.messages.into(),
            damaged: counters.damaged().into(),
            late: self.late,
        }
    }

    /// The error for a drive that has answered no sample for `limit`.
    #[must_use]
    pub fn silent(&self, limit: Duration) -> SessionError {
        self.line.silent(EncoderSample::LAYOUT.name, limit)
    }

    /// The timestamps of the last exchange.
    #[must_use]
    pub fn timestamps(&self) -> Timestamps {
        self.timestamps
    }

    /// The link's present time, of which every deadline is an instant.
    pub fn now(&mut self) -> Instant {
        self.line.now()
    }

    /// Waits until an instant of the link's time.
    ///
    /// # Errors
    /// The line broke.
    pub fn wait_until(&mut self, until: Instant) -> Result<(), SessionError> {
        self.line.wait_until(until)
    }

    /// Chooses the clock of a link that has a time of its own.
    pub fn set_time_base(&mut self, time_base: TimeBase) {
        self.line.set_time_base(time_base);
    }

    /// Announces that nothing is sent or received until `until`, see [`Link::idle`].
    ///
    /// # Errors
    /// The line broke.
    pub fn idle(&mut self, until: Instant) -> Result<(), SessionError> {
        self.line.idle(until)
    }
}
