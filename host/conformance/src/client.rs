//! The bench's side of a conformance run: requests and all their answers.

use std::time::{Duration, Instant};

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{
    GetParameter, Identity, ParameterReport, Reset, SetParameter, Start, TorqueAnswer,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use lashloop_link::Link;
use lashloop_session::line::Line;
use lashloop_session::{Description, Parameter, SessionError, handshake};

use super::answers::{command_result, hello, identity, report, sample, torque};
use super::assertion::{Failure, RuleResult, broken, equal, preparation};
use super::range::in_type_of;
use super::time_up::{Starvation, TimeUp};
use super::words::Words;

/// Time for the answers to one request. A drive answers at once.
pub(super) const REQUEST_LIMIT: Duration = Duration::from_secs(1);

/// Numbers of the sessions that settle a drive differ in these bits from those of the checks.
const SETTLING: u32 = 0x5e77_1e00;
/// Mean time of an exchange from which a drive or its line is slow: some 230,400 Bd.
const SLOW: Duration = Duration::from_micros(1_500);
/// As above, for a drive on which repetitions are barely possible.
const SLOWEST: Duration = Duration::from_micros(2_500);

/// Index that no drive has, since the parameter count is a byte. Reading it has no effect in any state, so its answer marks
/// the end of the answers to the request before it.
const NO_PARAMETER: u8 = u8::MAX;

/// Parameter that selects the law; a drive with one law may omit it.
pub(super) const CONTROLLER: &str = "controller";

/// A drive under test.
pub(super) struct Client {
    pub(super) line: Line,
    pub(super) session: u32,
    pub(super) identity: Identity,
    /// What the drive describes, as far as a drive can have it.
    pub(super) description: Description,
    /// What no drive can have, in words.
    pub(super) defects: Vec<String>,
    /// State of the drive after the last request.
    pub(super) state: State,
    /// A measurement of the check, for information.
    pub(super) note: String,
    /// The end of the time for the present check.
    time_up: TimeUp,
    /// When the first request was sent.
    pub(super) opened_at: Instant,
    /// Mean time of a request and its answer.
    exchange: Duration,
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
    /// Times that the drive was settled.
    settled: u8,
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
        let time_up =
            TimeUp { at: line.now() + REQUEST_LIMIT, cause: "", starvation: Starvation::look(&mut line) };
        let (state, note) = (identity.state, String::new());
        let (slowest, waited_until, settled) = (Duration::ZERO, line.now(), 0);
        Ok(Self {
            line,
            session,
            identity,
            description,
            defects,
            state,
            note,
            time_up,
            opened_at,
            exchange,
            describing,
            slowest,
            waited_until,
            is_unsettled: false,
            is_unanswered: false,
            settled,
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
        Err(Failure::NotJudged {
            cause: format!("description read in {took_s:.1} s, too slow for this check"),
        })
    }

    /// Lets late answers to earlier requests pass: all have arrived when a `Hello` of a new session is answered. Returns whether
    /// the end of an earlier request's answers was among them.
    pub(super) fn settle(&mut self) -> Result<bool, Failure> {
        if !self.is_unsettled {
            return Ok(false);
        }
        let mut is_late = false;
        self.settled = self.settled.wrapping_add(1);
        let session = self.session ^ SETTLING ^ u32::from(self.settled);
        self.line.send(&hello(session).into())?;
        let answered = self.wait_for(2 * REQUEST_LIMIT, |message| match message {
            DriveMessage::Identity(it) if it.session == session => Some(it.state),
            DriveMessage::ParameterReport(it) if it.index == NO_PARAMETER => {
                is_late = true;
                None
            }
            _ => None,
        })?;
        self.is_unsettled = answered.is_none();
        Ok(is_late)
    }

    /// Whether the present check has given up on an answer that comes after all: the drive, its line or its machine stood still.
    pub(super) fn is_answered_late(&mut self) -> Result<bool, Failure> {
        Ok(std::mem::take(&mut self.is_unanswered) && self.settle()?)
    }

    /// Resets the drive. The answer is left for the next host.
    pub(super) fn leave(mut self) -> Result<(), SessionError> {
        self.line.send(&Reset {}.into())
    }

    /// Sends a request and returns all of its answers but `Log`, which a drive may send at any time. A read of
    /// [`NO_PARAMETER`] after it marks their end.
    pub(super) fn request(&mut self, request: impl Into<HostMessage>) -> Result<Vec<DriveMessage>, Failure> {
        self.request_bytes(&request.into().frame())
    }

    /// As [`Self::request`], for arbitrary bytes.
    pub(super) fn request_bytes(&mut self, bytes: &[u8]) -> Result<Vec<DriveMessage>, Failure> {
        let mut answers = self.request_with_logs(bytes)?;
        answers.retain(|answer| !matches!(answer, DriveMessage::Log(_)));
        Ok(answers)
    }

    /// As [`Self::request_bytes`], with every `Log` in its place.
    pub(super) fn request_with_logs(&mut self, bytes: &[u8]) -> Result<Vec<DriveMessage>, Failure> {
        let marker = HostMessage::from(GetParameter { index: NO_PARAMETER });
        self.send_bytes(&[bytes, &*marker.frame()].concat())?;
        let requests = bytes.iter().filter(|byte| **byte == DELIMITER).count() as u32 + 1;
        let sent_at = self.line.now();
        let mut answers = Vec::new();
        let mut heard = 0;
        loop {
            // Each request of a burst has a time of its own; other messages extend none.
            let limit = REQUEST_LIMIT * (heard + 1).min(requests);
            let rest = (sent_at + limit).saturating_duration_since(self.line.now());
            let Some(message) = self.wait_for(rest, |message| Some(*message))? else { break };
            match message {
                DriveMessage::ParameterReport(report) if report.index == NO_PARAMETER => {
                    self.state = report.state;
                    let waited = self.line.now().saturating_duration_since(sent_at);
                    self.slowest = self.slowest.max(waited / requests);
                    return Ok(answers);
                }
                DriveMessage::Log(_) => {}
                _ => heard += 1,
            }
            answers.push(message);
        }
        (self.is_unsettled, self.is_unanswered) = (true, true);
        let limit_s = REQUEST_LIMIT.as_secs();
        Err(broken(
            format!("within {limit_s} s the answer to the next good request, GetParameter {NO_PARAMETER}"),
            if answers.is_empty() { "nothing".to_owned() } else { format!("only {}", answers.words()) },
        ))
    }

    /// Sends a request whose last answer `is_last` accepts, and returns all of its answers up to that one but `Log`. A surplus
    /// answer is found before the answers to the next request. Without the last answer, the answers end at a marker.
    pub(super) fn request_until(
        &mut self,
        request: impl Into<HostMessage>,
        is_last: impl Fn(&DriveMessage) -> bool,
    ) -> Result<Vec<DriveMessage>, Failure> {
        self.send_bytes(&request.into().frame())?;
        let sent_at = self.line.now();
        let mut answers = Vec::new();
        let last = self.wait_for(REQUEST_LIMIT, |message| {
            if !matches!(message, DriveMessage::Log(_)) {
                answers.push(*message);
            }
            is_last(message).then_some(*message)
        })?;
        let waited = self.line.now().saturating_duration_since(sent_at);
        if last.is_some() {
            self.slowest = self.slowest.max(waited);
        }
        if last.is_none() {
            answers.extend(self.request_bytes(&[])?);
        } else if let Some(state) = answers.iter().filter_map(state_in).next_back() {
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

    pub(super) fn send_bytes(&mut self, bytes: &[u8]) -> RuleResult {
        self.require_time()?;
        self.line.send_bytes(bytes)?;
        self.note_lateness(self.waited_until);
        Ok(())
    }

    /// Begins a check.
    pub(super) fn begin(&mut self, time_up: TimeUp) {
        (self.time_up, self.slowest) = (time_up, Duration::ZERO);
    }

    /// # Errors
    /// The time for the present check is up.
    fn require_time(&mut self) -> RuleResult {
        if !self.time_up.has_come(&mut self.line) {
            return Ok(());
        }
        self.is_unsettled = true;
        Err(Failure::NotJudged { cause: self.time_up.cause.to_owned() })
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
            let ends_at = deadline.min(self.time_up.at);
            let found = self.line.wait(ends_at, &mut wanted)?;
            self.note_lateness(deadline);
            if found.is_some() || ends_at == deadline {
                return Ok(found);
            }
            self.require_time()?;
        }
    }

    /// Sends a request that is answered by a `CommandResult`, and returns its outcome and state.
    pub(super) fn command(&mut self, command: impl Into<HostMessage>) -> Result<(Outcome, State), Failure> {
        let command = command.into();
        let kind = command.layout().kind;
        let answers = if kind == Start::LAYOUT.kind {
            // The receiver's counts of a run start with the marker, in every check.
            self.request(command)?
        } else {
            self.request_until(
                command,
                |answer| matches!(answer, DriveMessage::CommandResult(it) if it.request == kind),
            )?
        };
        command_result(command.layout(), &answers).map(|result| (result.outcome, result.state))
    }

    pub(super) fn handshake(&mut self, session: u32) -> Result<Identity, Failure> {
        let request = hello(session);
        if self.state == State::Faulted {
            return identity(&self.request(request)?);
        }
        identity(&self.request_until(request, |answer| matches!(answer, DriveMessage::Identity(_)))?)
    }

    pub(super) fn parameter(&self, name: &str) -> Result<&Parameter, Failure> {
        let found = self.description.parameters.iter().find(|parameter| parameter.name == name);
        let found = found.ok_or_else(|| broken(format!("a parameter {name}"), "a drive without it"));
        preparation(format!("a parameter {name}"), found)
    }

    /// Index of the law in force after a reset.
    pub(super) fn default_law(&self) -> u8 {
        match self.parameter(CONTROLLER).map(|it| it.default) {
            Ok(ParameterValue::U32(index)) => index as u8,
            _ => 0,
        }
    }

    /// Sets a parameter, as a preparation. An integer is sent in the parameter's own type: the page allows `F32` for numbers
    /// with a reserved name.
    pub(super) fn put(&mut self, name: &str, value: ParameterValue) -> RuleResult {
        let parameter = self.parameter(name)?;
        let index = parameter.index;
        let value = in_type_of(parameter, value);
        let set = self.set(index, value).and_then(|report| {
            equal(&format!("{name} = {value}:"), (Outcome::Accepted, value), (report.outcome, report.value))
        });
        preparation(format!("SetParameter {name}"), set)
    }

    /// As [`Self::put`], for several parameters.
    pub(super) fn put_all(&mut self, settings: &[(&str, ParameterValue)]) -> RuleResult {
        settings.iter().try_for_each(|(name, value)| self.put(name, *value))
    }

    pub(super) fn set(&mut self, index: u8, value: ParameterValue) -> Result<ParameterReport, Failure> {
        report(index, &self.request_until(SetParameter { index, value }, reports(index))?)
    }

    pub(super) fn get(&mut self, index: u8) -> Result<ParameterReport, Failure> {
        report(index, &self.request_until(GetParameter { index }, reports(index))?)
    }

    /// The value of a real parameter, as a preparation.
    pub(super) fn real(&mut self, name: &str) -> Result<f32, Failure> {
        let index = self.parameter(name)?.index;
        let value = self.get(index).and_then(|report| match report.value {
            ParameterValue::F32(value) => Ok(value),
            ParameterValue::U32(value) => {
                Err(broken(format!("{name} of type F32"), format!("the U32 {value}")))
            }
        });
        preparation(format!("GetParameter {name}"), value)
    }

    /// Sends a sample with the mechanics at rest at zero, and returns all answers.
    pub(super) fn sample(&mut self, sequence: u16) -> Result<Vec<DriveMessage>, Failure> {
        self.request(sample(sequence))
    }

    /// Sends the sample of [`Self::sample`] and returns its torque.
    pub(super) fn torque(&mut self, sequence: u16) -> Result<TorqueAnswer, Failure> {
        torque(&self.request_to(sample(sequence), TorqueAnswer::LAYOUT.name)?)
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

/// Whether an answer is the report of a parameter.
fn reports(index: u8) -> impl Fn(&DriveMessage) -> bool {
    move |answer| matches!(answer, DriveMessage::ParameterReport(it) if it.index == index)
}
