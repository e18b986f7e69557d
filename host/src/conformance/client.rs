//! The bench's side of a conformance run: requests, and everything that comes in answer to each.

use std::time::{Duration, Instant};

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    GetParameter, Hello, Identity, ParameterReport, Reset, SetParameter, TorqueAnswer,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, Message, PROTOCOL_VERSION};

use lashloop_bench::link::Link;
use lashloop_bench::session::line::{Line, REQUEST_LIMIT};
use lashloop_bench::session::{Parameter, SessionError, greeting, parameters};

use super::answers::{identity, report, sample, torque};
use super::assertion::{Failure, RuleResult, equal, find};

/// No drive has a parameter of this index, since a count of parameters is a byte. So a question for it changes nothing
/// in any state, and its answer ends the answers to what was asked before.
const NO_PARAMETER: u8 = u8::MAX;

/// A drive under test.
pub(super) struct Client {
    line: Line,
    session: u32,
    identity: Identity,
    parameters: Vec<Parameter>,
    /// State of the drive after the last request.
    state: State,
    note: String,
}

impl Client {
    pub(super) fn open(link: Box<dyn Link>, session: u32) -> Result<Self, SessionError> {
        let mut line = Line::new(link);
        line.clear()?;
        let identity = greeting::greet(&mut line, session)?;
        let parameters = parameters::learn(&mut line, identity.parameter_count)?;
        Ok(Self { line, session, identity, parameters, state: identity.state, note: String::new() })
    }

    /// Leaves the drive as after power-up; what it has to say to that is for the next host.
    pub(super) fn leave(mut self) -> Result<(), SessionError> {
        self.line.send(&Reset {}.into())
    }

    pub(super) fn identity(&self) -> &Identity {
        &self.identity
    }

    pub(super) fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    pub(super) fn session(&self) -> u32 {
        self.session
    }

    pub(super) fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    pub(super) fn note(&mut self, note: String) {
        self.note = note;
    }

    pub(super) fn take_note(&mut self) -> String {
        std::mem::take(&mut self.note)
    }

    /// Sends a request and returns everything that comes before the answer to the question behind it.
    pub(super) fn request(&mut self, request: impl Into<HostMessage>) -> Result<Vec<DriveMessage>, Failure> {
        self.request_bytes(&request.into().frame())
    }

    /// The same for bytes that need not be frames.
    pub(super) fn request_bytes(&mut self, bytes: &[u8]) -> Result<Vec<DriveMessage>, Failure> {
        let question = HostMessage::from(GetParameter { index: NO_PARAMETER });
        self.send_bytes(&[bytes, &*question.frame()].concat())?;
        let mut answers = Vec::new();
        let state = self.wait_for(REQUEST_LIMIT, |message| match message {
            DriveMessage::ParameterReport(report) if report.index == NO_PARAMETER => Some(report.state),
            answer => {
                answers.push(*answer);
                None
            }
        })?;
        if let Some(state) = state {
            self.state = state;
            return Ok(answers);
        }
        Err(Failure::Rule {
            expected: format!(
                "within {} s an answer to the next good request, GetParameter {NO_PARAMETER}",
                REQUEST_LIMIT.as_secs()
            ),
            came: if answers.is_empty() { "nothing".to_owned() } else { format!("{answers:?} and no more") },
        })
    }

    pub(super) fn send_bytes(&mut self, bytes: &[u8]) -> RuleResult {
        self.line.send_bytes(bytes).map_err(Failure::Session)
    }

    /// What comes unasked, until `wanted` recognises it or the limit has passed.
    pub(super) fn wait_for<T>(
        &mut self,
        limit: Duration,
        wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        self.line.wait(Instant::now() + limit, wanted).map_err(Failure::Session)
    }

    /// Sends a request that has no answer of its own and returns what became of it.
    pub(super) fn command<C: Payload + Into<HostMessage>>(
        &mut self,
        command: C,
    ) -> Result<(Outcome, State), Failure> {
        let answers = self.request(command)?;
        find(&format!("a CommandResult for {}", C::LAYOUT.name), &answers, |answer| match answer {
            DriveMessage::CommandResult(result) if result.request == C::LAYOUT.kind => {
                Some((result.outcome, result.state))
            }
            _ => None,
        })
    }

    /// State of the drive after the last request.
    pub(super) fn state(&self) -> State {
        self.state
    }

    pub(super) fn handshake(&mut self, session: u32) -> Result<Identity, Failure> {
        identity(&self.request(Hello { protocol_version: PROTOCOL_VERSION, session })?)
    }

    pub(super) fn parameter(&self, name: &str) -> Result<&Parameter, Failure> {
        self.parameters.iter().find(|parameter| parameter.name == name).ok_or_else(|| Failure::Rule {
            expected: format!("a parameter {name}"),
            came: "a drive without it".to_owned(),
        })
    }

    /// Sets a parameter that has to be taken.
    pub(super) fn put(&mut self, name: &str, value: ParameterValue) -> RuleResult {
        let index = self.parameter(name)?.index;
        let report = self.set(index, value)?;
        equal(&format!("{name} = {value}:"), (Outcome::Accepted, value), (report.outcome, report.value))
    }

    pub(super) fn set(&mut self, index: u8, value: ParameterValue) -> Result<ParameterReport, Failure> {
        report(index, &self.request(SetParameter { index, value })?)
    }

    pub(super) fn get(&mut self, index: u8) -> Result<ParameterReport, Failure> {
        report(index, &self.request(GetParameter { index })?)
    }

    /// The value in force of a real parameter.
    pub(super) fn real(&mut self, name: &str) -> Result<f32, Failure> {
        let index = self.parameter(name)?.index;
        match self.get(index)?.value {
            ParameterValue::F32(value) => Ok(value),
            ParameterValue::U32(value) => Err(Failure::Rule {
                expected: format!("a real number in {name}"),
                came: format!("the integer {value}"),
            }),
        }
    }

    /// A sample with the mechanics at rest at zero, and all that comes for it.
    pub(super) fn sample(&mut self, sequence: u16) -> Result<Vec<DriveMessage>, Failure> {
        self.request(sample(sequence))
    }

    /// The torque for a sample of [`Self::sample`].
    pub(super) fn torque(&mut self, sequence: u16) -> Result<TorqueAnswer, Failure> {
        torque(&self.sample(sequence)?)
    }
}
