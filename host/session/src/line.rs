//! Messages on a link: sends and decodes them, and keeps those that come unasked.

use std::ops::Range;
use std::time::{Duration, Instant};

use lashloop_link::{Link, LinkError, TimeBase};
use lashloop_protocol::message::{FaultReport, LineReport, Telemetry};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, MAX_FRAME, Message, Numbered};

use crate::at_step::AtStep;
use crate::device_clock::DeviceClock;
use crate::diagnosis::{Collector, Diagnosis};
use crate::error::{LastSeen, SessionError};
use crate::logs::Logs;
use crate::patience::{PATIENCE, Patience};
use crate::telemetry_count::TelemetryCount;

/// A link with a decoder at its end.
pub struct Line {
    link: Box<dyn Link>,
    /// Decoder of the received bytes, with its counters.
    pub decoder: Decoder,
    outbox: [u8; MAX_FRAME],
    inbox: Box<[u8; 4096]>,
    /// The part of `inbox` that holds bytes not decoded yet.
    unread: Range<usize>,
    /// Number of the present session; 0 before the first handshake.
    pub session: u32,
    /// Number of the last request; 0 before the first.
    number: u8,
    /// Frames sent since the line was opened.
    pub frames_sent: u64,
    /// Progress of the session, for error messages.
    pub last_seen: LastSeen,
    /// The latest telemetry.
    pub telemetry: Option<AtStep<Telemetry>>,
    /// The telemetry of the present run.
    pub telemetry_count: TelemetryCount,
    /// The latest fault report.
    pub fault: Option<AtStep<FaultReport>>,
    /// The latest line report.
    pub report: Option<LineReport>,
    /// The latest texts of the drive, and notes about it.
    pub logs: Logs,
    clock: DeviceClock,
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
            outbox: [0; MAX_FRAME],
            inbox: Box::new([0; 4096]),
            unread: 0..0,
            session: 0,
            number: 0,
            frames_sent: 0,
            last_seen: LastSeen::default(),
            telemetry: None,
            telemetry_count: TelemetryCount::default(),
            fault: None,
            report: None,
            logs: Logs::default(),
            clock: DeviceClock::default(),
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
        // Another drive may be there, or the same after a loss of power.
        self.clock = DeviceClock::default();
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

    /// The number of the next request: 1 to 255 in turn.
    pub fn next_number(&mut self) -> u8 {
        self.number = self.number % u8::MAX + 1;
        self.number
    }

    /// Sends a request with a number of its own, or a sample.
    ///
    /// # Errors
    /// The line broke.
    pub fn send(&mut self, message: &HostMessage) -> Result<(), SessionError> {
        let number = if message.layout().has_number() { self.next_number() } else { 0 };
        self.send_numbered(&Numbered { number, message: *message })
    }

    /// Sends a message with this number.
    ///
    /// # Errors
    /// The line broke.
    pub fn send_numbered(&mut self, message: &Numbered<HostMessage>) -> Result<(), SessionError> {
        self.frames_sent += 1;
        self.collector.sent(message);
        if message.number != 0 {
            let now = self.link.now();
            self.clock.ask(message.number, now);
        }
        let sent = self.link.send(message.message.write_numbered(message.number, &mut self.outbox));
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

    /// As [`Self::wait_numbered`], for a caller to whom the numbers of answers mean nothing.
    ///
    /// # Errors
    /// The line broke.
    pub fn wait<T>(
        &mut self,
        deadline: Instant,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        self.wait_numbered(deadline, |it| wanted(&it.message))
    }

    /// As [`Self::wait_numbered`], for the answer to the request of this number, or to a sample with number 0. What a drive
    /// sends unasked passes too; an answer of another number is late and passes not.
    ///
    /// # Errors
    /// The line broke.
    pub fn answer<T>(
        &mut self,
        number: u8,
        deadline: Instant,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        self.wait_numbered(deadline, |it| {
            let is_late = it.number != number && it.message.layout().has_number();
            if is_late { None } else { wanted(&it.message) }
        })
    }

    /// Waits for the message that `wanted` recognises; `None` at the deadline, even if messages keep arriving. Messages that
    /// have arrived are read even after the deadline: a bench that overslept must not report a silent drive.
    ///
    /// # Errors
    /// The line broke.
    pub fn wait_numbered<T>(
        &mut self,
        deadline: Instant,
        mut wanted: impl FnMut(&Numbered<DriveMessage>) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        let mut last_look = false;
        loop {
            while let Some(message) = self.decoded() {
                if let Some(answer) = wanted(&message) {
                    self.collector.awaited(self.unread.len());
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
        // The link's time may have moved.
        self.clock = DeviceClock::default();
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
    fn decoded(&mut self) -> Option<Numbered<DriveMessage>> {
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
                    self.telemetry_count.note_bad(&error);
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

    /// What arrived since the last message that a wait returned, and its probable cause.
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

    fn note(&mut self, Numbered { number, message }: &Numbered<DriveMessage>) {
        self.last_seen.note(message);
        self.telemetry_count.note(message);
        let formed_at = self.formed_at(*number, message);
        let step = self.last_seen.sample_sent.unwrap_or(0);
        match message {
            DriveMessage::Telemetry(it) => self.telemetry = Some(AtStep::near(step, it.sequence, *it)),
            DriveMessage::FaultReport(it) => self.fault = Some(AtStep::near(step, it.sequence, *it)),
            // That of an earlier stop is late.
            DriveMessage::LineReport(report) if *number == self.number => self.report = Some(*report),
            DriveMessage::Log(log) => self.logs.receive(*log, formed_at),
            _ => {}
        }
    }

    /// When the drive formed a message that has just been read, in the link's time.
    fn formed_at(&mut self, number: u8, message: &DriveMessage) -> Option<Instant> {
        let device_us = (*{ *message }.device_time_us_mut()?)?;
        let now = self.link.now();
        self.clock.hear(number, device_us, now);
        self.clock.time_of(device_us, now)
    }
}
