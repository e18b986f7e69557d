//! A drive to talk to, in every state.

use std::time::Duration;

use lashloop_firmware::drive::{Clock, Drive, ManualClock};
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    Arm, ClearFault, EmergencyStop, EncoderSample, GetParameter, Hello, Reset, SetParameter, Start, Stop,
};
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, HostMessage, Message, PROTOCOL_VERSION};

pub const SESSION: u32 = 7;
pub const HELLO: Hello = Hello { protocol_version: PROTOCOL_VERSION, session: SESSION };

pub struct Talk {
    pub drive: Drive,
    clock: ManualClock,
}

impl Talk {
    /// A drive that is in this state, by the shortest way.
    pub fn in_state(state: State) -> Self {
        let mut talk = Self { drive: Drive::new("document"), clock: ManualClock::default() };
        let way: &[HostMessage] = &[
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
        };
        for message in &way[..steps] {
            talk.say(*message);
        }
        assert_eq!(talk.drive.state(), state);
        talk
    }

    /// Running, with these parameters.
    pub fn running(parameters: &[(&str, ParameterValue)]) -> Self {
        let mut talk = Self::in_state(State::Idle);
        for (name, value) in parameters {
            talk.say(SetParameter { index: index(name), value: *value });
        }
        talk.say(Arm { session: SESSION });
        talk.say(Start { session: SESSION });
        assert_eq!(talk.drive.state(), State::Running);
        talk
    }

    pub fn say(&mut self, message: impl Into<HostMessage>) -> Vec<DriveMessage> {
        let frame = message.into().frame();
        assert_eq!(self.drive.receive(&frame, &self.clock), frame.len());
        self.listen()
    }

    /// A sample with the load and the motor at rest at zero.
    pub fn sample(&mut self, sequence: u16) -> Vec<DriveMessage> {
        self.say(rest(sequence))
    }

    /// Lets device time pass without a look at the watchdog.
    pub fn wait(&mut self, time: Duration) {
        self.clock.advance(time);
    }

    /// The drive looks at its watchdog.
    pub fn tick(&mut self) -> Vec<DriveMessage> {
        self.drive.tick(self.clock.now());
        self.listen()
    }

    fn listen(&mut self) -> Vec<DriveMessage> {
        let mut decoder = Decoder::new();
        let mut said = self.drive.output();
        let answers =
            std::iter::from_fn(|| decoder.next(&mut said)).map(|it| it.expect("a good frame")).collect();
        self.drive.clear_output();
        answers
    }
}

pub fn rest(sequence: u16) -> EncoderSample {
    let [motor_counts, load_counts] = [EncoderCounts::default(); 2];
    EncoderSample { sequence, motor_counts, load_counts, reference_rad: 0.0 }
}

/// Index of the parameter of this name.
pub fn index(name: &str) -> u8 {
    let table = lashloop_firmware::drive::parameters::TABLE;
    let index = table.iter().position(|entry| entry.name == name);
    index.unwrap_or_else(|| panic!("no parameter {name}")) as u8
}

/// What the document calls `request`; the part after the comma is a case of it.
pub fn request(name: &str) -> HostMessage {
    let other = SESSION + 1;
    match name {
        "Hello, same session" => HELLO.into(),
        "Hello, another session" => Hello { session: other, ..HELLO }.into(),
        "Hello, another version" => Hello { protocol_version: PROTOCOL_VERSION + 1, session: other }.into(),
        "DescribeParameter" => lashloop_protocol::message::DescribeParameter { index: 0 }.into(),
        "GetParameter" => GetParameter { index: 0 }.into(),
        "SetParameter" => set("k_p1", ParameterValue::F32(2.0)),
        "SetParameter, live" => set("telemetry_every", ParameterValue::U32(5)),
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

/// Why a request was refused, if it was.
pub fn refusal(answers: &[DriveMessage]) -> Option<Outcome> {
    let mut outcomes = answers.iter().filter_map(|answer| match answer {
        DriveMessage::CommandResult(result) => Some(result.outcome),
        DriveMessage::ParameterReport(report) => Some(report.outcome),
        _ => None,
    });
    outcomes.find(|outcome| *outcome != Outcome::Accepted)
}

/// The names of messages, as the document lists them.
pub fn names(answers: &[DriveMessage]) -> String {
    answers.iter().map(|answer| answer.layout().name).collect::<Vec<_>>().join(", ")
}
