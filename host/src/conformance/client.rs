//! The bench's side of a conformance run: requests, and everything that comes in answer to each.

use std::time::{Duration, Instant};

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::frame::DELIMITER;
use lashloop_protocol::message::{
    Arm, EmergencyStop, EncoderSample, FaultReport, GetParameter, Hello, Identity, ParameterReport, Reset,
    SetParameter, Start, TorqueAnswer,
};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage, Message, PROTOCOL_VERSION};

use super::check::{Checked, Failure, equal, find};
use lashloop_bench::link::Link;
use lashloop_bench::session::line::Line;
use lashloop_bench::session::request::REQUEST_LIMIT;
use lashloop_bench::session::{Parameter, SessionError, handshake, parameters};

/// No drive has a parameter of this index, since a count of parameters is a byte. So a question for it changes nothing
/// in any state, and its answer ends the answers to what was asked before.
const NO_PARAMETER: u8 = u8::MAX;

/// Long enough for any bench on any machine, so that no watchdog trips in a check of something else.
const PATIENT_WATCHDOG_US: u32 = 30_000_000;

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
        let identity = handshake::shake_hands(&mut line, session)?;
        let parameters = parameters::read_all(&mut line, identity.parameter_count)?;
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
    pub(super) fn say(&mut self, request: impl Into<HostMessage>) -> Result<Vec<DriveMessage>, Failure> {
        self.say_bytes(&request.into().frame())
    }

    /// The same for bytes that need not be frames.
    pub(super) fn say_bytes(&mut self, bytes: &[u8]) -> Result<Vec<DriveMessage>, Failure> {
        let question = HostMessage::from(GetParameter { index: NO_PARAMETER });
        self.send_bytes(&[bytes, &*question.frame()].concat())?;
        let mut answers = Vec::new();
        let state = self.listen(REQUEST_LIMIT, |message| match message {
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

    pub(super) fn send_bytes(&mut self, bytes: &[u8]) -> Checked {
        self.line.send_bytes(bytes).map_err(Failure::Session)
    }

    /// The link's present time.
    pub(super) fn now(&mut self) -> Instant {
        self.line.now()
    }

    /// What comes unasked, until `wanted` recognises it or the limit has passed.
    pub(super) fn listen<T>(
        &mut self,
        limit: Duration,
        wanted: impl FnMut(&DriveMessage) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        let deadline = self.line.now() + limit;
        self.line.wait(deadline, wanted).map_err(Failure::Session)
    }

    /// Sends a request that has no answer of its own and returns what became of it.
    pub(super) fn command<C: Payload + Into<HostMessage>>(
        &mut self,
        command: C,
    ) -> Result<(Outcome, State), Failure> {
        let answers = self.say(command)?;
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

    /// Brings the drive to where it is after power-up, whatever the check before has left.
    pub(super) fn fresh(&mut self) -> Checked {
        // Ends whatever half frame was left.
        self.send_bytes(&[DELIMITER])?;
        let came = self.command(Reset {})?;
        equal("before the check, Reset", (Outcome::Accepted, State::Boot), came)
    }

    /// Greets with the session of this run.
    pub(super) fn idle(&mut self) -> Checked {
        let identity = self.greet(self.session)?;
        equal("after the greeting, state", State::Idle, identity.state)
    }

    pub(super) fn armed(&mut self) -> Checked {
        self.idle()?;
        self.arm()
    }

    pub(super) fn arm(&mut self) -> Checked {
        let session = self.session;
        let came = self.command(Arm { session })?;
        equal("Arm in Idle", (Outcome::Accepted, State::Armed), came)
    }

    pub(super) fn start(&mut self) -> Checked {
        let session = self.session;
        let came = self.command(Start { session })?;
        equal("Start in Armed", (Outcome::Accepted, State::Running), came)
    }

    /// Greets, sets these parameters, arms and starts.
    pub(super) fn running(&mut self, settings: &[(&str, ParameterValue)]) -> Checked {
        self.idle()?;
        self.put("watchdog_us", ParameterValue::U32(PATIENT_WATCHDOG_US))?;
        for (name, value) in settings {
            self.put(name, *value)?;
        }
        self.arm()?;
        self.start()
    }

    pub(super) fn faulted(&mut self) -> Checked {
        self.idle()?;
        let came = self.command(EmergencyStop {})?;
        equal("EmergencyStop", (Outcome::Accepted, State::Faulted), came)
    }

    /// Brings a fresh drive into this state.
    pub(super) fn enter(&mut self, state: State) -> Checked {
        match state {
            State::Boot => Ok(()),
            State::Idle => self.idle(),
            State::Armed => self.armed(),
            State::Running => self.running(&[]),
            State::Faulted => self.faulted(),
        }
    }

    pub(super) fn greet(&mut self, session: u32) -> Result<Identity, Failure> {
        identity(&self.say(Hello { protocol_version: PROTOCOL_VERSION, session })?)
    }

    pub(super) fn parameter(&self, name: &str) -> Result<&Parameter, Failure> {
        self.parameters.iter().find(|parameter| parameter.name == name).ok_or_else(|| Failure::Rule {
            expected: format!("a parameter {name}"),
            came: "a drive without it".to_owned(),
        })
    }

    /// Sets a parameter that has to be taken.
    pub(super) fn put(&mut self, name: &str, value: ParameterValue) -> Checked {
        let index = self.parameter(name)?.index;
        let report = self.set(index, value)?;
        equal(&format!("{name} = {value}:"), (Outcome::Accepted, value), (report.outcome, report.value))
    }

    pub(super) fn set(&mut self, index: u8, value: ParameterValue) -> Result<ParameterReport, Failure> {
        report(index, &self.say(SetParameter { index, value })?)
    }

    pub(super) fn get(&mut self, index: u8) -> Result<ParameterReport, Failure> {
        report(index, &self.say(GetParameter { index })?)
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
        self.say(sample(sequence))
    }

    /// The torque for a sample of [`Self::sample`].
    pub(super) fn torque(&mut self, sequence: u16) -> Result<TorqueAnswer, Failure> {
        torque(&self.sample(sequence)?)
    }
}

/// The mechanics at rest at zero, and the load wanted at 1 rad: any controller pushes.
pub(super) fn sample(sequence: u16) -> EncoderSample {
    let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
    EncoderSample { sequence, motor_counts, load_counts, reference_rad: 1.0 }
}

/// The identity among answers.
pub(super) fn identity(answers: &[DriveMessage]) -> Result<Identity, Failure> {
    find("an Identity", answers, |answer| match answer {
        DriveMessage::Identity(identity) => Some(*identity),
        _ => None,
    })
}

/// The torque among answers.
pub(super) fn torque(answers: &[DriveMessage]) -> Result<TorqueAnswer, Failure> {
    find("a TorqueAnswer", answers, |answer| match answer {
        DriveMessage::TorqueAnswer(answer) => Some(*answer),
        _ => None,
    })
}

/// The fault among answers.
pub(super) fn fault(answers: &[DriveMessage]) -> Result<FaultReport, Failure> {
    find("a FaultReport", answers, |answer| match answer {
        DriveMessage::FaultReport(fault) => Some(*fault),
        _ => None,
    })
}

/// What became of a request among answers to it.
pub(super) fn outcome<Request: Payload>(answers: &[DriveMessage]) -> Result<Outcome, Failure> {
    let what = format!("a CommandResult for {}", Request::LAYOUT.name);
    find(&what, answers, |answer| match answer {
        DriveMessage::CommandResult(result) if result.request == Request::LAYOUT.kind => Some(result.outcome),
        _ => None,
    })
}

/// The report of a parameter among answers.
pub(super) fn report(index: u8, answers: &[DriveMessage]) -> Result<ParameterReport, Failure> {
    find(&format!("a ParameterReport for index {index}"), answers, |answer| match answer {
        DriveMessage::ParameterReport(report) if report.index == index => Some(*report),
        _ => None,
    })
}
