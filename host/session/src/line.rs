//! Messages on a link: sends and decodes them, and keeps those that come unasked.

use std::ops::Range;
use std::time::{Duration, Instant};

use lashloop_link::{Link, LinkError, TimeBase};
use lashloop_protocol::message::{FaultReport, LineReport, Telemetry};
use lashloop_protocol::wire::BodyError;
use lashloop_protocol::{Decoder, DriveMessage, FrameError, HostMessage, MAX_FRAME, Message};

use crate::at_step::AtStep;
use crate::diagnosis::{Collector, Diagnosis};
use crate::error::{LastSeen, SessionError};
use crate::logs::Logs;
use crate::patience::{PATIENCE, Patience};

/// A link with a decoder at its end.
pub struct Line {
    link: Box<dyn Link>,
    /// Decoder of the received bytes, with its counters.
    pub decoder: Decoder,
    /// Frames of a kind that only a later version may have.
    pub later_kinds: u32,
    outbox: [u8; MAX_FRAME],
    inbox: Box<[u8; 4096]>,
    /// The part of `inbox` that holds bytes not decoded yet.
    unread: Range<usize>,
    /// Number of the present session; 0 before the first handshake.
    pub session: u32,
    /// Frames sent since the line was opened.
    pub frames_sent: u64,
    /// Progress of the session, for error messages.
    pub last_seen: LastSeen,
    /// The latest telemetry.
    pub telemetry: Option<AtStep<Telemetry>>,
    /// The latest fault report.
    pub fault: Option<AtStep<FaultReport>>,
    /// The latest line report.
    pub report: Option<LineReport>,
    /// The latest texts of the drive, and notes about it.
    pub logs: Logs,
    collector: Collector,
    pub(crate) patience: Patience,
    time_base: TimeBase,
    /// When the bytes decoded last were read, as [`Line::timestamp`] gives it.
    pub arrived: Instant,
}

impl Line {
    /// A line over a link. Nothing is sent yet.
    #[must_use]
    pub fn new(link: Box<dyn Link>) -> Self {
        Self {
            link,
            decoder: Decoder::new(),
            later_kinds: 0,
            outbox: [0; MAX_FRAME],
            inbox: Box::new([0; 4096]),
            unread: 0..0,
            session: 0,
            frames_sent: 0,
            last_seen: LastSeen::default(),
            telemetry: None,
            fault: None,
            report: None,
            logs: Logs::default(),
            collector: Collector::default(),
            patience: Patience::default(),
            time_base: TimeBase::WallClock,
            arrived: Instant::now(),
        }
    }

    /// Discards all input and ends the partial frame that an earlier host may have left in the drive's decoder.
    ///
    /// # Errors
    /// The line broke.
    pub fn clear(&mut self) -> Result<(), SessionError> {
        self.unread = 0..0;
        self.decoder.forget_partial();
        self.collector.clear();
        self.patience = Patience::default();
        self.link.discard_input().map_err(|error| self.broken(error))?;
        self.end_frame()
    }

    /// Ends a partial frame in the drive's decoder.
    ///
    /// # Errors
    /// The line broke.
    pub fn end_frame(&mut self) -> Result<(), SessionError> {
        self.send_bytes(&[lashloop_protocol::frame::DELIMITER])
    }

    /// Sends a message.
    ///
    /// # Errors
    /// The line broke.
    pub fn send(&mut self, message: &HostMessage) -> Result<(), SessionError> {
        self.frames_sent += 1;
        self.collector.sent(message);
        let sent = self.link.send(message.write_frame(&mut self.outbox));
        sent.map_err(|error| self.broken(error))
    }

    /// Sends bytes as they are; they need not be frames.
    ///
    /// # Errors
    /// The line broke.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> Result<(), SessionError> {
        self.collector.sent_bytes(bytes);
        self.link.send(bytes).map_err(|error| self.broken(error))
    }

    /// Waits for the message that `wanted` recognises; `None` at the deadline, even if messages keep arriving. Messages that
    /// have arrived are read even after the deadline: a bench that overslept must not report a silent drive.
    ///
    /// # Errors
    /// The line broke.
    pub fn wait<T>(
        &mut self,
        deadline: Instant,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        let mut last_look = false;
        loop {
            while let Some(message) = self.decoded() {
                if let Some(answer) = wanted(&message) {
                    self.collector.awaited();
                    return Ok(Some(answer));
                }
                self.collector.other(&message);
            }
            if last_look {
                return Ok(None);
            }
            let now = self.now();
            self.collector.waits(now);
            last_look = now >= deadline;
            match self.link.receive(&mut self.inbox[..], deadline) {
                Ok(0) => {
                    self.collector.waits(deadline.max(now));
                    return Ok(None);
                }
                Ok(count) => {
                    self.arrived = self.timestamp();
                    self.collector.read(count);
                    self.unread = 0..count;
                }
                Err(error) => return Err(self.broken(error)),
            }
        }
    }

    /// The link's present time, of which every deadline is an instant.
    pub fn now(&mut self) -> Instant {
        self.link.now()
    }

    /// Time for which the programs at the far end have waited for a core, see [`Link::starved`].
    pub fn starved(&mut self) -> Duration {
        self.link.starved()
    }

    /// Waits until an instant of the link's time.
    ///
    /// # Errors
    /// The line broke.
    pub fn wait_until(&mut self, until: Instant) -> Result<(), SessionError> {
        self.link.wait_until(until).map_err(|error| self.broken(error))
    }

    /// Chooses the clock of a link that has a time of its own.
    pub fn set_time_base(&mut self, time_base: TimeBase) {
        self.time_base = time_base;
        self.link.set_time_base(time_base);
    }

    /// The present time for measurements: of the wall clock, unless time is scripted.
    pub fn timestamp(&mut self) -> Instant {
        if self.time_base == TimeBase::Scripted { self.link.now() } else { Instant::now() }
    }

    /// Announces that nothing is sent or received until `until`, see [`Link::idle`].
    ///
    /// # Errors
    /// The line broke.
    pub fn idle(&mut self, until: Instant) -> Result<(), SessionError> {
        self.link.idle(until).map_err(|error| self.broken(error))
    }

    /// Decodes the next good message of the bytes received. Telemetry, reports and logs are kept on the way.
    fn decoded(&mut self) -> Option<DriveMessage> {
        loop {
            let mut bytes = &self.inbox[self.unread.clone()];
            let decoded = self.decoder.next::<DriveMessage>(&mut bytes);
            let consumed = self.unread.start..self.unread.end - bytes.len();
            self.unread.start = consumed.end;
            match decoded {
                Some(Ok(message)) => {
                    self.collector.good();
                    self.note(&message);
                    return Some(message);
                }
                Some(Err(error)) => {
                    if matches!(error, FrameError::Body(BodyError::UnknownKind { kind: 0x81.. })) {
                        self.later_kinds = self.later_kinds.saturating_add(1);
                    }
                    self.collector.bad(&self.inbox[consumed], &error);
                }
                None => {
                    self.collector.partial(&self.inbox[consumed]);
                    return None;
                }
            }
        }
    }

    /// The error for a drive that did not answer `waiting_for` within `limit`, or within the time for all requests.
    #[must_use]
    pub fn silent(&self, waiting_for: &'static str, limit: Duration) -> SessionError {
        let last_seen = self.last_seen;
        if self.patience.is_exhausted() {
            let (limit, requests) = (PATIENCE, self.patience.waits);
            return SessionError::Slow { waiting_for, limit, requests, last_seen };
        }
        SessionError::Silent { waiting_for, limit, last_seen, diagnosis: Box::new(self.diagnosis()) }
    }

    /// What arrived since the last message that a [`Line::wait`] returned, and its probable cause.
    #[must_use]
    pub fn diagnosis(&self) -> Diagnosis {
        self.collector.diagnosis()
    }

    /// Answers since the line was opened that no wait returned: late, doubled, or to the requests of another host.
    #[must_use]
    pub fn surplus_answers(&self) -> u32 {
        self.collector.surplus_answers()
    }

    fn broken(&self, source: LinkError) -> SessionError {
        let has_unknown_bytes = self.last_seen.frame.is_none() && self.collector.has_arrivals();
        let diagnosis = has_unknown_bytes.then(|| Box::new(self.diagnosis()));
        SessionError::Broken { source, last_seen: self.last_seen, diagnosis }
    }

    fn note(&mut self, message: &DriveMessage) {
        self.last_seen.note(message);
        let step = self.last_seen.sample_sent.unwrap_or(0);
        match message {
            DriveMessage::Telemetry(it) => self.telemetry = Some(AtStep::near(step, it.sequence, *it)),
            DriveMessage::FaultReport(it) => self.fault = Some(AtStep::near(step, it.sequence, *it)),
            DriveMessage::LineReport(report) => self.report = Some(*report),
            DriveMessage::Log(log) => self.logs.receive(*log),
            _ => {}
        }
    }
}
