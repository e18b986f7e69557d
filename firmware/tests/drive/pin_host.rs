//! A host of a drive with pins, and the pins.

use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::actuator::StageCommand;
use lashloop_firmware::drive::{Drive, ManualClock, PinHardware, PinParameters, PinReadings};
use lashloop_firmware::input_filter::FILTERS;
use lashloop_firmware::law::{LawSet, Parameter, ParameterGroup};
use lashloop_firmware::power_stage::StageMode;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    Arm, BenchSample, FaultReport, ParameterReport, Reference, Reset, SetParameter, Start,
};
use lashloop_protocol::{DriveMessage, EncoderCounts, HostMessage};

use crate::host::{HELLO, SESSION};
use crate::line::{self, Line};

pub const PERIOD: Duration = Duration::from_millis(1);
/// Counters of 16 bits, and a timer of 16 bits that counts microseconds.
pub const HARDWARE: PinHardware = PinHardware {
    largest_move_counts: 32_767,
    filters: &FILTERS,
    stage_modes: &[StageMode::Amplifier],
    longest_period_us: 65_535,
    measures_current: true,
    has_index: [true, false],
};

pub const BENCH: [(&str, ParameterValue); 3] = [
    ("sample_source", ParameterValue::U32(1)),
    ("torque_per_duty_nm", ParameterValue::F32(1000.0)),
    ("torque_limit_nm", ParameterValue::F32(100.0)),
];

pub struct PinHost {
    pub drive: Drive,
    pub clock: ManualClock,
    pub readings: PinReadings,
    /// Due time of the next tick.
    pub due: Duration,
    pub number: u16,
    line: Line,
}

impl PinHost {
    /// A host of a drive in a session, whose pins have been read once.
    pub fn idle() -> Self {
        let mut host = Self::powered_up();
        assert_eq!(host.tick(), []);
        host
    }

    fn powered_up() -> Self {
        let mut host = Self {
            drive: Drive::with_pins("test", HARDWARE),
            clock: ManualClock::default(),
            readings: PinReadings::default(),
            due: PERIOD,
            number: 0,
            line: Line::default(),
        };
        host.send(HELLO);
        host
    }

    /// As [`Self::with`], with pins that were not read since power-up.
    pub fn unread() -> Self {
        let mut host = Self::powered_up();
        host.set_all(&[]);
        host
    }

    /// As [`Self::idle`], with [`BENCH`] and then these parameters.
    pub fn with(parameters: &[(&str, ParameterValue)]) -> Self {
        let mut host = Self::idle();
        host.set_all(parameters);
        host
    }

    /// Resets the drive to the same session, with [`BENCH`].
    pub fn reset(&mut self) {
        self.send(Reset {});
        self.send(HELLO);
        self.set_all(&[]);
    }

    fn set_all(&mut self, parameters: &[(&str, ParameterValue)]) {
        for (name, value) in BENCH.iter().chain(parameters) {
            assert_eq!(self.set(name, *value).outcome, Outcome::Accepted, "{name}");
        }
    }

    /// A host of a drive that runs on its pins.
    pub fn running(parameters: &[(&str, ParameterValue)]) -> Self {
        let mut host = Self::with(parameters);
        assert_eq!(host.arm(), (Outcome::Accepted, State::Armed));
        assert_eq!(host.start(), (Outcome::Accepted, State::Running));
        host
    }

    /// A running drive with a torque other than zero.
    pub fn under_torque() -> Self {
        let mut host = Self::running(&[]);
        host.refer(1.0);
        assert_ne!(host.step().torque_nm, 0.0);
        host
    }

    pub fn arm(&mut self) -> (Outcome, State) {
        self.command(Arm { session: SESSION })
    }

    pub fn start(&mut self) -> (Outcome, State) {
        self.command(Start { session: SESSION })
    }

    pub fn send(&mut self, message: impl Into<HostMessage>) -> Vec<DriveMessage> {
        let message = message.into();
        let frame = self.line.request(&message);
        assert_eq!(self.drive.receive(&frame, &self.clock), frame.len());
        let answers = self.line.take(&mut self.drive);
        self.line.answers(&message, answers)
    }

    /// The result of a refusal, and nothing before it.
    pub fn refusal(&mut self, message: impl Into<HostMessage>) -> (Outcome, u32, State) {
        line::refusal(&self.send(message))
    }

    pub fn command(&mut self, message: impl Into<HostMessage>) -> (Outcome, State) {
        let answers = self.send(message);
        match answers.iter().find(|it| matches!(it, DriveMessage::CommandResult(_))) {
            Some(DriveMessage::CommandResult(result)) => (result.outcome, result.state),
            _ => panic!("no result in {answers:?}"),
        }
    }

    pub fn set(&mut self, name: &str, value: ParameterValue) -> ParameterReport {
        match self.send(SetParameter { index: index(name), value })[..] {
            [DriveMessage::ParameterReport(report)] => report,
            ref other => panic!("{other:?}"),
        }
    }

    /// Sends the next reference, which an accepting drive doesn't answer.
    pub fn refer(&mut self, reference_rad: f32) {
        self.number = self.number.wrapping_add(1);
        assert_eq!(self.send(Reference { number: self.number, reference_rad }), []);
    }

    /// The next tick, in time.
    pub fn tick(&mut self) -> Vec<DriveMessage> {
        self.tick_after(Duration::ZERO)
    }

    /// The next tick, with this lateness.
    pub fn tick_after(&mut self, lateness: Duration) -> Vec<DriveMessage> {
        self.clock.set(self.due + lateness);
        self.drive.sample(&self.readings, self.due, &self.clock);
        self.due += PERIOD;
        self.take_output()
    }

    /// The next tick, which must be a reported control step.
    pub fn step(&mut self) -> BenchSample {
        match self.tick()[..] {
            [DriveMessage::BenchSample(sample), ..] => sample,
            ref other => panic!("no step: {other:?}"),
        }
    }

    pub fn turn(&mut self, motor: i64, load: i64) {
        self.readings.motor.counts = EncoderCounts::wrapping(motor);
        self.readings.load.counts = EncoderCounts::wrapping(load);
    }

    /// Torque of the power stage in N m; `None` if it is off.
    pub fn stage_nm(&self) -> Option<f32> {
        match self.drive.stage_command() {
            StageCommand::Off => None,
            StageCommand::Torque { torque_nm, .. } => Some(torque_nm),
        }
    }

    /// Requires that this fault is latched and that the stage is off.
    pub fn assert_faulted(&self, answers: &[DriveMessage], code: FaultCode) -> FaultReport {
        let Some(DriveMessage::FaultReport(report)) = answers.last() else {
            panic!("no report in {answers:?}")
        };
        assert_eq!(report.code, code);
        assert_eq!((self.drive.state(), self.drive.torque_nm()), (State::Faulted, 0.0));
        assert_eq!(self.stage_nm(), None, "{code} leaves the power stage on");
        *report
    }

    pub fn take_output(&mut self) -> Vec<DriveMessage> {
        line::messages(self.line.take(&mut self.drive))
    }
}

/// The parameters of a drive with pins, in the order of their indices.
pub fn table() -> impl Iterator<Item = &'static Parameter> {
    Laws::PARAMETERS.iter().chain(PinParameters::TABLE)
}

/// Index of the parameter of this name.
pub fn index(name: &str) -> u8 {
    let index = table().position(|parameter| parameter.name == name);
    index.unwrap_or_else(|| panic!("no parameter {name}")) as u8
}
