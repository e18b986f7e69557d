//! The bench's side of a conformance run: requests and all their answers.

use std::collections::VecDeque;

use lashloop_link::Link;
use lashloop_protocol::frame::Frame;
use lashloop_session::line::Line;
use lashloop_session::{Description, handshake};

use super::arrivals::Arrivals;
use super::assertion::{Failure, RuleResult, broken};
use super::power_stage::PowerStage;
use super::time_up::{Starvation, TimeUp};
use super::words::Words;
use super::writes::next_write;
use crate::prelude::wire::*;

/// Time for the answers to one request. A drive answers at once.
pub(super) const REQUEST_LIMIT: Duration = Duration::from_secs(1);

/// More answers to the requests of one write than any drive gives.
const MOST_ANSWERS: usize = 200;
/// Messages that are read after a deadline at most, as they may have arrived before it.
const MOST_OVERDUE: u32 = 1_000;
/// Mean time of an exchange from which a drive or its line is slow: some 230,400 Bd.
const SLOW: Duration = Duration::from_micros(1_500);
/// As above, for a drive on which repetitions are barely possible.
const SLOWEST: Duration = Duration::from_micros(2_500);

/// Index that no drive has. Reading it has no effect in any state, so its answer marks the end of the answers to the request
/// before it.
const NO_PARAMETER: u8 = u8::MAX;

/// A drive under test.
pub(super) struct Client {
    pub(super) line: Line,
    pub(super) session: u32,
    pub(super) identity: Identity,
    /// What the drive describes, as far as a drive can have it.
    pub(super) description: Description,
    /// What no drive can have, in words.
    pub(super) defects: Vec<String>,
    pub(super) arrivals: Arrivals,
    /// Whether the drive may turn its power stage on, and how.
    pub(super) bench_mode: Option<PowerStage>,
    /// Whether an `Arm` in bench mode has found the encoders read since power-up.
    pub(super) has_read_encoders: bool,
    /// Whether the drive loses requests of one write, so that each is sent alone.
    pub(super) sends_alone: bool,
    /// Answers that arrived before the last requests of a call were sent.
    early: VecDeque<DriveMessage>,
    /// Messages read after a deadline, one after the other.
    overdue: u32,
    /// State of the drive after the last request.
    pub(super) state: State,
    /// A measurement of the check, for information.
    pub(super) note: String,
    /// The end of the time for the present check.
    time_up: TimeUp,
    /// At the last look.
    starvation: Starvation,
    /// When the first request was sent.
    pub(super) opened_at: Instant,
    /// Mean time of a request and its answer.
    pub(super) exchange: Duration,
    /// Time for the description.
    describing: Duration,
    /// Longest time in the present check for an answer, or by which the bench itself was late.
    pub(super) slowest: Duration,
    /// When the last wait ended: the bench continues at once.
    waited_until: Instant,
    /// Whether answers to earlier requests may still arrive.
    pub(super) is_unsettled: bool,
    /// Whether the present check has given up on an answer.
    is_unanswered: bool,
}

impl Client {
    pub(super) fn open(link: Box<dyn Link>, session: u32) -> Result<Self, SessionError> {
        let mut line = Line::new(link);
        let opened_at = line.now();
        line.clear()?;
        let identity = handshake::shake_hands(&mut line, session)?;
        let (started, frames) = (line.now(), line.decoder.counters().messages);
        let (description, defects) = Description::read_with_defects(&mut line, &identity)?;
        let answers = (line.decoder.counters().messages - frames).max(1);
        let describing = line.now().saturating_duration_since(started);
        let exchange = describing / answers;
        let defects = defects.iter().map(ToString::to_string).collect();
        let starvation = Starvation::look(&mut line);
        let time_up = TimeUp { at: line.now() + REQUEST_LIMIT, cause: String::new(), starvation };
        let arrivals = Arrivals::new(&identity);
        let (state, waited_until) = (identity.state, line.now());
        Ok(Self {
            line,
            session,
            // The checks compare messages without it.
            identity: Identity { device_time_us: None, ..identity },
            description,
            defects,
            arrivals,
            bench_mode: None,
            has_read_encoders: false,
            sends_alone: false,
            early: VecDeque::new(),
            overdue: 0,
            state,
            note: String::new(),
            time_up,
            starvation,
            opened_at,
            exchange,
            describing,
            slowest: Duration::ZERO,
            waited_until,
            is_unsettled: false,
            is_unanswered: false,
        })
    }

    /// How often to repeat what a drive may do wrongly only later: `most` times, fewer on a slow line.
    pub(super) fn repetitions(&self, most: usize) -> usize {
        match self.exchange {
            exchange if exchange < SLOW => most,
            exchange if exchange < SLOWEST => most.div_ceil(2),
            _ => most.min(1),
        }
    }

    /// Requires time to read the description again, as long as the first time.
    pub(super) fn has_time_to_describe(&mut self) -> RuleResult {
        if self.line.now() + self.describing <= self.time_up.at {
            return Ok(());
        }
        let took_s = self.describing.as_secs_f32();
        let cause = format!("description read in {took_s:.1} s, too slow for this check");
        Err(Failure::NotJudged { cause })
    }

    /// Lets late answers to earlier requests pass: all have arrived when a read is answered. Returns whether the end of an
    /// earlier request's answers was among them.
    pub(super) fn settle(&mut self) -> Result<bool, Failure> {
        if !self.is_unsettled {
            return Ok(false);
        }
        self.arrivals.skips_late = true;
        let read = self.frame(GetParameter { index: NO_PARAMETER });
        self.write(&read)?;
        let deadline = self.line.now() + 2 * REQUEST_LIMIT;
        let mut ends = 0;
        while self.arrivals.is_waiting()
            && let Some(message) = self.receive(deadline)?
        {
            ends += u32::from(is_end(&message));
        }
        self.is_unsettled = self.arrivals.is_waiting();
        Ok(ends > 1)
    }

    /// Discards what belongs to the requests before a `Reset`. Answers to them are late from here on.
    pub(super) fn forget(&mut self) -> RuleResult {
        self.line.clear()?;
        self.arrivals.forget_partial();
        self.arrivals.skips_late = true;
        self.early.clear();
        self.settle()?;
        self.arrivals.close();
        Ok(())
    }

    /// Whether the present check has given up on an answer that comes after all: the drive, its line or its machine stood still.
    pub(super) fn is_answered_late(&mut self) -> Result<bool, Failure> {
        Ok(std::mem::take(&mut self.is_unanswered) && self.settle()?)
    }

    /// Resets the drive. The answer is left for the next host.
    pub(super) fn leave(mut self) -> Result<(), SessionError> {
        self.line.send(&Reset {}.into())
    }

    /// The frame of a request, with a number of its own.
    pub(super) fn frame(&mut self, request: impl Into<HostMessage>) -> Frame {
        request.into().numbered_frame(self.arrivals.next_number())
    }

    /// Sends a request and returns all of its answers but `Log`, which a drive may send at any time. A read of
    /// [`NO_PARAMETER`] after it marks their end.
    pub(super) fn request(&mut self, request: impl Into<HostMessage>) -> Result<Vec<DriveMessage>, Failure> {
        let frame = self.frame(request);
        self.request_bytes(&frame)
    }

    /// As [`Self::request`], for arbitrary bytes.
    pub(super) fn request_bytes(&mut self, bytes: &[u8]) -> Result<Vec<DriveMessage>, Failure> {
        let marker = self.frame(GetParameter { index: NO_PARAMETER });
        self.send_bytes(&[bytes, &*marker].concat())?;
        let requests = bytes.iter().filter(|byte| **byte == DELIMITER).count() as u32 + 1;
        let sent_at = self.line.now();
        // Each request of a burst has a time of its own, from the answer before it; other messages extend none.
        let mut waits_since = sent_at;
        let mut answers = Vec::new();
        while answers.len() < MOST_ANSWERS {
            let rest = (waits_since + REQUEST_LIMIT).saturating_duration_since(self.line.now());
            let Some(message) = self.wait_for(rest, |message| Some(*message))? else {
                if !self.has_starved() {
                    break;
                }
                waits_since = self.line.now();
                continue;
            };
            if is_end(&message) {
                let waited = self.line.now().saturating_duration_since(sent_at);
                self.slowest = self.slowest.max(waited / requests);
                self.arrivals.close();
                self.state = state_in(&message).unwrap_or(self.state);
                return Ok(answers);
            }
            if !matches!(message, DriveMessage::Log(_)) {
                answers.push(message);
                if answers.len() < requests as usize {
                    waits_since = self.line.now();
                }
            }
        }
        (self.is_unsettled, self.is_unanswered) = (true, true);
        let limit_s = REQUEST_LIMIT.as_secs();
        Err(broken(
            format!("within {limit_s} s the answer to the next good request, GetParameter {NO_PARAMETER}"),
            if answers.is_empty() { "nothing".to_owned() } else { format!("only {}", answers.words()) },
        ))
    }

    /// Sends a request whose last answer `is_last` accepts, and returns all of its answers up to that one but `Log`. A surplus
    /// answer is found with the next request. Without the last answer, the answers end at a marker.
    pub(super) fn request_until(
        &mut self,
        request: impl Into<HostMessage>,
        is_last: impl Fn(&DriveMessage) -> bool,
    ) -> Result<Vec<DriveMessage>, Failure> {
        let frame = self.frame(request);
        self.send_bytes(&frame)?;
        let sent_at = self.line.now();
        let mut answers = Vec::new();
        let last = self.wait_for(REQUEST_LIMIT, |message| {
            if !matches!(message, DriveMessage::Log(_)) {
                answers.push(*message);
            }
            (is_last(message) || answers.len() > MOST_ANSWERS).then_some(*message)
        })?;
        if last.is_none() {
            answers.extend(self.request_bytes(&[])?);
            return Ok(answers);
        }
        let waited = self.line.now().saturating_duration_since(sent_at);
        self.slowest = self.slowest.max(waited);
        self.arrivals.close();
        if let Some(state) = answers.iter().filter_map(state_in).next_back() {
            self.state = state;
        }
        Ok(answers)
    }

    /// As [`Self::request_until`], for the name of the last answer's kind.
    pub(super) fn request_to(
        &mut self,
        request: impl Into<HostMessage>,
        last: &str,
    ) -> Result<Vec<DriveMessage>, Failure> {
        self.request_until(request, |answer| answer.layout().name == last)
    }

    /// As [`Self::request_until`], for a request whose first answer is its only one.
    pub(super) fn request_one(
        &mut self,
        request: impl Into<HostMessage>,
    ) -> Result<Vec<DriveMessage>, Failure> {
        self.request_until(request, |answer| !matches!(answer, DriveMessage::Log(_)))
    }

    /// Sends bytes, in writes that every drive takes. The requests of a write are answered before the next one.
    pub(super) fn send_bytes(&mut self, bytes: &[u8]) -> RuleResult {
        let mut rest = bytes;
        while !rest.is_empty() {
            if self.sends_alone || rest.len() < bytes.len() {
                self.await_answers()?;
            }
            let (write, later) = rest.split_at(next_write(rest, self.sends_alone));
            self.write(write)?;
            rest = later;
        }
        Ok(())
    }

    fn write(&mut self, bytes: &[u8]) -> RuleResult {
        self.require_time()?;
        self.arrivals.sent(bytes);
        self.line.send_bytes(bytes)?;
        self.note_lateness(self.waited_until);
        Ok(())
    }

    /// Keeps the answers to all requests sent.
    fn await_answers(&mut self) -> RuleResult {
        while self.arrivals.is_waiting() && self.early.len() < MOST_ANSWERS {
            let deadline = self.line.now() + REQUEST_LIMIT;
            let Some(message) = self.receive(deadline)? else { break };
            self.early.push_back(message);
        }
        Ok(())
    }

    /// Whether the drive's program has waited for a core for long since the last look, so that it isn't silent.
    fn has_starved(&mut self) -> bool {
        let now = Starvation::look(&mut self.line);
        std::mem::replace(&mut self.starvation, now).until(now) > REQUEST_LIMIT / 4
    }

    /// Begins a check.
    pub(super) fn begin(&mut self, time_up: TimeUp) {
        self.starvation = time_up.starvation;
        (self.time_up, self.slowest) = (time_up, Duration::ZERO);
    }

    /// # Errors
    /// The time for the present check is up.
    fn require_time(&mut self) -> RuleResult {
        if !self.time_up.has_come(&mut self.line) {
            return Ok(());
        }
        self.is_unsettled = true;
        Err(Failure::NotJudged { cause: self.time_up.cause.clone() })
    }

    /// Notes by how much the bench is later than `due`.
    fn note_lateness(&mut self, due: Instant) {
        self.waited_until = self.line.now();
        self.slowest = self.slowest.max(self.waited_until.saturating_duration_since(due));
    }

    /// Receives messages until `wanted` accepts one or the limit has passed.
    pub(super) fn wait_for<T>(
        &mut self,
        limit: Duration,
        mut wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        let deadline = self.line.now() + limit;
        loop {
            let message = match self.early.pop_front() {
                Some(early) => early,
                None => match self.receive(deadline)? {
                    Some(message) => message,
                    None => return Ok(None),
                },
            };
            if let Some(found) = wanted(&message) {
                return Ok(Some(found));
            }
        }
    }

    /// The next message, checked and without its device time; `None` at the deadline.
    fn receive(&mut self, deadline: Instant) -> Result<Option<DriveMessage>, Failure> {
        loop {
            self.overdue = if self.line.now() > deadline { self.overdue + 1 } else { 0 };
            let ends_at = deadline.min(self.time_up.at);
            let arrived = self.line.wait_numbered(ends_at, |arrived| Some(*arrived))?;
            self.note_lateness(deadline);
            match arrived {
                _ if self.overdue > MOST_OVERDUE => return Ok(None),
                Some(arrived) => {
                    if let Some(message) = self.arrivals.take(&arrived)? {
                        return Ok(Some(message));
                    }
                }
                None if ends_at == deadline => return Ok(None),
                None => self.require_time()?,
            }
        }
    }
}

/// The state in an answer, after it was sent.
fn state_in(answer: &DriveMessage) -> Option<State> {
    match answer {
        DriveMessage::Identity(it) => Some(it.state),
        DriveMessage::TorqueAnswer(it) => Some(it.status.state),
        DriveMessage::CommandResult(it) => Some(it.state),
        DriveMessage::ParameterReport(it) => Some(it.state),
        _ => None,
    }
}

/// Whether an answer marks the end of those to the request before it.
const fn is_end(answer: &DriveMessage) -> bool {
    matches!(answer, DriveMessage::ParameterReport(it) if it.index == NO_PARAMETER)
}
