//! A host that drives the firmware's state machine directly, in every state.

use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::drive::{Clock, Drive, ManualClock};
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::layout::has_number;
use lashloop_protocol::message::{
    Arm, ClearFault, DescribeChoice, DescribeLaw, DescribeParameter, DescribeSignal, EmergencyStop,
    EncoderSample, GetParameter, Hello, Reset, SetParameter, Start, Stop, Subscribe,
};
use lashloop_protocol::parameter_names::CONTROLLER;
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, HostMessage, Message, PROTOCOL_VERSION};

pub const SESSION: u32 = 7;
pub const HELLO: Hello = Hello::new(SESSION);

pub struct Host<L: LawSet = Laws> {
    pub drive: Drive<L>,
    clock: ManualClock,
    /// Number of the last request.
    number: u8,
}

impl<L: LawSet> Host<L> {
    /// A drive in this state, by the shortest sequence of requests.
    pub fn with_laws_in_state(state: State) -> Self {
        let mut host = Self { drive: Drive::with_laws("document"), clock: ManualClock::default(), number: 0 };
        let requests: &[HostMessage] = &[
            HELLO.into(),
            Arm { session: SESSION }.into(),
            Start { session: SESSION }.into(),
            EmergencyStop {}.into(),
        ];
        let steps = match state {
            State::Boot => 0,
            State::Idle => 1,
            State::Armed => 2,
            State::Running => 3,
            State::Faulted => 4,
            State::Unknown(byte) => panic!("no drive has the state {byte:?}"),
        };
        for request in &requests[..steps] {
            host.send(*request);
        }
        assert_eq!(host.drive.state(), state);
        host
    }

    /// The answers to a request of the next number, which they must repeat.
    pub fn send(&mut self, message: impl Into<HostMessage>) -> Vec<DriveMessage> {
        let message = message.into();
        self.number = self.number % u8::MAX + 1;
        let number = if message.layout().has_number() { self.number } else { 0 };
        self.exchange(&message.numbered_frame(number), number)
    }

    /// The answers to the bytes of a request, each with this number if its kind has one.
    pub fn exchange(&mut self, frame: &[u8], number: u8) -> Vec<DriveMessage> {
        assert_eq!(self.drive.receive(frame, &self.clock), frame.len());
        self.receive(number)
    }

    /// A sample with the load and the motor at rest at zero.
    pub fn sample(&mut self, sequence: u16) -> Vec<DriveMessage> {
        self.send(rest(sequence))
    }

    /// Advances device time without a check of the watchdog.
    pub fn wait(&mut self, time: Duration) {
        self.clock.advance(time);
    }

    /// Makes the drive check its watchdog.
    pub fn tick(&mut self) -> Vec<DriveMessage> {
        self.drive.tick(self.clock.now());
        self.receive(0)
    }

    fn receive(&mut self, number: u8) -> Vec<DriveMessage> {
        let mut decoder = Decoder::new();
        let mut output = self.drive.output();
        let mut answers = Vec::new();
        while let Some(answer) = decoder.next::<DriveMessage>(&mut output) {
            let answer = answer.expect("a good frame");
            let expected = if has_number(answer.message.layout().kind) { number } else { 0 };
            assert_eq!(answer.number, expected, "{answer:?}");
            answers.push(answer.message);
        }
        self.drive.clear_output();
        answers
    }
}

impl Host {
    /// A Lashloop drive in this state.
    pub fn in_state(state: State) -> Self {
        Self::with_laws_in_state(state)
    }

    /// A running Lashloop drive with these parameters.
    pub fn running(parameters: &[(&str, ParameterValue)]) -> Self {
        let mut host = Self::in_state(State::Idle);
        for (name, value) in parameters {
            host.send(SetParameter { index: index(name), value: *value });
        }
        host.send(Arm { session: SESSION });
        host.send(Start { session: SESSION });
        assert_eq!(host.drive.state(), State::Running);
        host
    }
}

pub fn rest(sequence: u16) -> EncoderSample {
    let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
    EncoderSample { sequence, motor_counts, load_counts, reference_rad: 0.0 }
}

/// Index of the parameter of this name.
pub fn index(name: &str) -> u8 {
    let index = Laws::PARAMETERS.iter().position(|parameter| parameter.name == name);
    index.unwrap_or_else(|| panic!("no parameter {name}")) as u8
}

/// The mask of the signals of these names.
pub fn signals(names: &[&str]) -> u32 {
    let index = |name: &&str| Laws::SIGNALS.iter().position(|signal| signal.name == *name);
    names.iter().map(|name| 1 << index(name).unwrap_or_else(|| panic!("no signal {name}"))).sum()
}

/// What the document calls `request`; the part after the comma is a case of it.
pub fn request(name: &str) -> HostMessage {
    let other = SESSION + 1;
    match name {
        "Hello, same session" => HELLO.into(),
        "Hello, another session" => Hello { session: other, ..HELLO }.into(),
        "Hello, another version" => {
            Hello { protocol_version: PROTOCOL_VERSION + 1, ..Hello::new(other) }.into()
        }
        "DescribeParameter" => DescribeParameter { index: 0 }.into(),
        "DescribeLaw" => DescribeLaw { index: 0 }.into(),
        "DescribeSignal" => DescribeSignal { index: 0 }.into(),
        "DescribeChoice" => DescribeChoice { parameter: index(CONTROLLER), choice: 0 }.into(),
        "Subscribe" => Subscribe { signals: signals(&["requested_torque_nm"]), every: 10 }.into(),
        "GetParameter" => GetParameter { index: 0 }.into(),
        "SetParameter" => set("reduction_ratio", ParameterValue::F32(2.0)),
        "SetParameter, live" => set("k_p1", ParameterValue::F32(2.0)),
        "Arm" => Arm { session: SESSION }.into(),
        "Arm, another session" => Arm { session: other }.into(),
        "Start" => Start { session: SESSION }.into(),
        "Start, another session" => Start { session: other }.into(),
        "Stop" => Stop {}.into(),
        "EmergencyStop" => EmergencyStop {}.into(),
        "ClearFault" => ClearFault {}.into(),
        "Reset" => Reset {}.into(),
        "EncoderSample" => rest(0).into(),
        other => panic!("the document has a request {other:?} that this test can't make"),
    }
}

fn set(name: &str, value: ParameterValue) -> HostMessage {
    SetParameter { index: index(name), value }.into()
}

/// Outcome of a refused request; `None` if every answer accepts.
pub fn refusal(answers: &[DriveMessage]) -> Option<Outcome> {
    refusal_with_detail(answers).map(|(outcome, _)| outcome)
}

/// Outcome and detail of a refused request; `None` if every answer accepts.
pub fn refusal_with_detail(answers: &[DriveMessage]) -> Option<(Outcome, u32)> {
    let mut outcomes = answers.iter().filter_map(|answer| match answer {
        DriveMessage::CommandResult(result) => Some((result.outcome, result.detail)),
        DriveMessage::ParameterReport(report) => Some((report.outcome, report.detail)),
        _ => None,
    });
    outcomes.find(|(outcome, _)| *outcome != Outcome::Accepted)
}

/// Names of the answers in the notation of the document.
pub fn names(answers: &[DriveMessage]) -> String {
    answers.iter().map(|answer| answer.layout().name).collect::<Vec<_>>().join(", ")
}
