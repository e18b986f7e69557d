//! A host that sets the device time.

use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::drive::{Clock, Drive, ManualClock};
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    Arm, CommandResult, EncoderSample, FaultReport, Hello, Identity, ParameterReport, SetParameter, Start,
    TorqueAnswer,
};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage, Numbered};

use crate::line::{self, Line};

pub const SESSION: u32 = 7;
pub const HELLO: Hello = Hello::new(SESSION);

/// The host of a drive with Lashloop's laws, unless others are named.
pub struct Host<L: LawSet = Laws> {
    pub drive: Drive<L>,
    pub clock: ManualClock,
    line: Line,
}

impl Host {
    pub fn new() -> Self {
        Self::of_laws()
    }

    /// As [`Self::in_session`].
    pub fn idle() -> Self {
        Self::in_session()
    }

    /// As [`Self::running_with`].
    pub fn running(parameters: &[(&str, ParameterValue)]) -> Self {
        Self::running_with(parameters)
    }
}

impl<L: LawSet> Host<L> {
    pub fn of_laws() -> Self {
        Self { drive: Drive::with_laws("test"), clock: ManualClock::default(), line: Line::default() }
    }

    /// A host of a disarmed drive in a session.
    pub fn in_session() -> Self {
        let mut host = Self::of_laws();
        host.send(HELLO);
        host
    }

    /// A host of a drive that runs with these parameters.
    pub fn running_with(parameters: &[(&str, ParameterValue)]) -> Self {
        let mut host = Self::in_session();
        for (name, value) in parameters {
            assert_eq!(host.set(name, *value).outcome, Outcome::Accepted, "{name}");
        }
        assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Accepted, State::Armed));
        assert_eq!(host.command(Start { session: SESSION }), (Outcome::Accepted, State::Running));
        host
    }

    /// Advances device time and ticks the drive.
    pub fn advance(&mut self, time: Duration) {
        self.clock.advance(time);
        self.drive.tick(self.clock.now());
    }

    /// Sends bytes and returns the drive's whole output, that of earlier ticks included.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> Vec<DriveMessage> {
        line::messages(self.exchange(bytes))
    }

    /// As [`Self::send_bytes`], with the numbers of the messages.
    pub fn exchange(&mut self, mut bytes: &[u8]) -> Vec<Numbered<DriveMessage>> {
        let mut answers = self.line.take(&mut self.drive);
        while !bytes.is_empty() {
            let used = self.drive.receive(bytes, &self.clock);
            bytes = &bytes[used..];
            answers.extend(self.line.take(&mut self.drive));
        }
        answers
    }

    pub fn take_output(&mut self) -> Vec<DriveMessage> {
        line::messages(self.line.take(&mut self.drive))
    }

    pub fn send(&mut self, message: impl Into<HostMessage>) -> Vec<DriveMessage> {
        let message = message.into();
        let frame = self.line.request(&message);
        let answers = self.exchange(&frame);
        self.line.answers(&message, answers)
    }

    /// The result of a refusal, and nothing before it.
    pub fn refusal(&mut self, message: impl Into<HostMessage>) -> (Outcome, u32, State) {
        line::refusal(&self.send(message))
    }

    pub fn command(&mut self, message: impl Into<HostMessage>) -> (Outcome, State) {
        let answers = self.send(message);
        let result = answers.iter().find_map(|answer| match answer {
            DriveMessage::CommandResult(CommandResult { outcome, state, .. }) => Some((*outcome, *state)),
            _ => None,
        });
        result.unwrap_or_else(|| panic!("no result in {answers:?}"))
    }

    pub fn identity(&mut self, hello: Hello) -> Identity {
        let answers = self.send(hello);
        let identity = answers.iter().find_map(|answer| match answer {
            DriveMessage::Identity(identity) => Some(*identity),
            _ => None,
        });
        identity.unwrap_or_else(|| panic!("no identity in {answers:?}"))
    }

    pub fn set(&mut self, name: &str, value: ParameterValue) -> ParameterReport {
        let index = Self::parameter(name);
        match self.send(SetParameter { index, value })[..] {
            [DriveMessage::ParameterReport(report)] => report,
            ref other => panic!("{other:?}"),
        }
    }

    /// Index of the parameter of this name.
    pub fn parameter(name: &str) -> u8 {
        let index = L::PARAMETERS.iter().position(|parameter| parameter.name == name);
        index.unwrap_or_else(|| panic!("no parameter {name}")) as u8
    }

    /// Bit of the signal of this name.
    pub fn signal(name: &str) -> u32 {
        let index = L::SIGNALS.iter().position(|signal| signal.name == name);
        1 << index.unwrap_or_else(|| panic!("no signal {name}"))
    }

    pub fn sample(&mut self, sequence: u16, motor_counts: i64, load_counts: i64) -> Vec<DriveMessage> {
        self.send(sample(sequence, motor_counts, load_counts))
    }
}

/// A sample at these counts with the reference at zero.
pub fn sample(sequence: u16, motor_counts: i64, load_counts: i64) -> EncoderSample {
    let [motor_counts, load_counts] = [motor_counts, load_counts].map(EncoderCounts::wrapping);
    EncoderSample { sequence, motor_counts, load_counts, reference_rad: 0.0 }
}

pub fn torque(answers: &[DriveMessage]) -> TorqueAnswer {
    match answers.first() {
        Some(DriveMessage::TorqueAnswer(answer)) => *answer,
        _ => panic!("the first answer to a sample is its torque: {answers:?}"),
    }
}

pub fn fault(answers: &[DriveMessage]) -> FaultReport {
    let fault = answers.iter().find_map(|answer| match answer {
        DriveMessage::FaultReport(report) => Some(*report),
        _ => None,
    });
    fault.unwrap_or_else(|| panic!("no fault in {answers:?}"))
}
