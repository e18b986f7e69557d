//! Messages on a link: sending, decoding, and keeping what comes unasked.

use std::ops::Range;
use std::time::{Duration, Instant};

use lashloop_protocol::message::{FaultReport, LineReport, Telemetry};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, MAX_FRAME, Message};

use super::logs::Logs;
use super::{AtStep, LastSeen, SessionError, greeting};
use crate::link::{Link, LinkError};

/// How long a request may take, all attempts at it together. Requests are answered at once; this is for a line that loses
/// frames, and for an emulator on a busy machine.
pub const REQUEST_LIMIT: Duration = Duration::from_secs(2);
/// How long an attempt may take before the request is made again, because it or its answer may be lost.
const ATTEMPT_LIMIT: Duration = Duration::from_millis(500);

/// What came of a request.
pub struct Answered<T> {
    /// The answer.
    pub with: T,
    /// The request was made more than once, so it may have been done before this answer.
    pub repeated: bool,
}

/// A link with a decoder at its end.
pub struct Line {
    link: Box<dyn Link>,
    decoder: Decoder,
    outbox: [u8; MAX_FRAME],
    inbox: Box<[u8; 4096]>,
    /// The part of `inbox` that holds bytes not decoded yet.
    unread: Range<usize>,
    /// Number of the session, once there is one.
    pub session: u32,
    pub frames_sent: u64,
    pub last_seen: LastSeen,
    pub telemetry: Option<AtStep<Telemetry>>,
    pub fault: Option<AtStep<FaultReport>>,
    pub report: Option<LineReport>,
    pub(crate) logs: Logs,
    /// When the bytes were read that were decoded last.
    pub arrived: Instant,
}

impl Line {
    pub fn new(link: Box<dyn Link>) -> Self {
        Self {
            link,
            decoder: Decoder::new(),
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
            arrived: Instant::now(),
        }
    }

    pub fn decoder(&self) -> &Decoder {
        &self.decoder
    }

    /// Throws away what is on the line and ends whatever half frame an earlier host left in the drive's decoder.
    pub fn clear(&mut self) -> Result<(), SessionError> {
        self.unread = 0..0;
        self.decoder.forget_partial();
        self.link.discard_input().map_err(|error| self.broken(error))?;
        self.end_frame()
    }

    /// Ends whatever half frame is in the drive's decoder.
    pub fn end_frame(&mut self) -> Result<(), SessionError> {
        self.send_bytes(&[lashloop_protocol::frame::DELIMITER])
    }

    pub fn send(&mut self, message: &HostMessage) -> Result<(), SessionError> {
        self.frames_sent += 1;
        let sent = self.link.send(message.write_frame(&mut self.outbox));
        sent.map_err(|error| self.broken(error))
    }

    /// Sends bytes as they are, which need not be frames.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> Result<(), SessionError> {
        self.link.send(bytes).map_err(|error| self.broken(error))
    }

    /// Waits for the message that `wanted` recognises; `None` at the deadline, even on a line that never stops talking.
    /// What is on the line already is looked at in any case, so a bench that slept through its deadline blames nobody.
    pub fn wait<T>(
        &mut self,
        deadline: Instant,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        let mut last_look = false;
        loop {
            while let Some(message) = self.decoded() {
                if let Some(answer) = wanted(&message) {
                    return Ok(Some(answer));
                }
            }
            if last_look {
                return Ok(None);
            }
            last_look = Instant::now() >= deadline;
            match self.link.receive(&mut self.inbox[..], deadline) {
                Ok(0) => return Ok(None),
                Ok(count) => {
                    self.arrived = Instant::now();
                    self.unread = 0..count;
                }
                Err(error) => return Err(self.broken(error)),
            }
        }
    }

    /// Says that nothing is going to be sent or waited for until a moment.
    pub fn idle(&mut self, until: Instant) -> Result<(), SessionError> {
        self.link.idle(until).map_err(|error| self.broken(error))
    }

    /// Sends a request, again if need be, and waits for the answer that `wanted` recognises.
    ///
    /// A request may be made again only if it may be done again: a drive does every one that reaches it.
    pub fn request<T>(
        &mut self,
        request: &HostMessage,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Answered<T>, SessionError> {
        let give_up = Instant::now() + REQUEST_LIMIT;
        let mut repeated = false;
        loop {
            if let Some(with) = self.attempt(request, ATTEMPT_LIMIT, &mut wanted)? {
                if repeated {
                    self.let_answers_pass()?;
                }
                return Ok(Answered { with, repeated });
            }
            if Instant::now() >= give_up {
                return Err(self.silent(request.layout().name, REQUEST_LIMIT));
            }
            repeated = true;
        }
    }

    /// Sends a request once and waits for its answer until a limit.
    pub fn attempt<T>(
        &mut self,
        request: &HostMessage,
        limit: Duration,
        wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, SessionError> {
        self.send(request)?;
        let answer = self.wait(Instant::now() + limit, wanted)?;
        if answer.is_none() {
            // What the line has left of a frame must not swallow what is said next.
            self.end_frame()?;
        }
        Ok(answer)
    }

    /// Answers to earlier attempts may still be under way, and must not be taken for those to a later request of the same
    /// kind. Answers keep their order, so once a greeting is answered there are none.
    fn let_answers_pass(&mut self) -> Result<(), SessionError> {
        greeting::greet(self, self.session).map(drop)
    }

    /// The next good message among the bytes received. Telemetry, faults and logs are kept on the way.
    fn decoded(&mut self) -> Option<DriveMessage> {
        loop {
            let mut bytes = &self.inbox[self.unread.clone()];
            let decoded = self.decoder.next::<DriveMessage>(&mut bytes);
            self.unread.start = self.unread.end - bytes.len();
            // A damaged frame is counted by the decoder; what it was can't be known.
            if let Ok(message) = decoded? {
                self.note(&message);
                return Some(message);
            }
        }
    }

    pub fn silent(&self, waiting_for: &'static str, limit: Duration) -> SessionError {
        SessionError::Silent { waiting_for, limit, last_seen: self.last_seen }
    }

    fn broken(&self, source: LinkError) -> SessionError {
        SessionError::Broken { source, last_seen: self.last_seen }
    }

    fn note(&mut self, message: &DriveMessage) {
        self.last_seen.note(message);
        let step = self.last_seen.sample_sent.unwrap_or(0);
        match message {
            DriveMessage::Telemetry(it) => self.telemetry = Some(AtStep::near(step, it.sequence, *it)),
            DriveMessage::FaultReport(it) => self.fault = Some(AtStep::near(step, it.sequence, *it)),
            DriveMessage::LineReport(report) => self.report = Some(*report),
            DriveMessage::Log(log) => self.logs.say(*log),
            _ => {}
        }
    }
}

/// What the drive says ends on somebody's terminal, so it gets no say in how that terminal behaves.
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}
