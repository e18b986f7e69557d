//! A host in device time.

use std::sync::OnceLock;
use std::time::Duration;

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{
    Arm, BenchSample, DescribeParameter, FaultReport, Hello, Identity, Reference, SetParameter, Start,
};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};
use lashloop_silicon::symbols::Symbols;

use crate::bench::Bench;

pub const SESSION: u32 = 0x5e55_1014;
/// Time after which the image has been up for long.
const BOOT: Duration = Duration::from_millis(20);
/// A byte on the line: 10 bits of 42 MHz by 46.
pub const BYTE: Duration = Duration::from_nanos(10_953);
/// Most that an answer takes.
const ANSWER: Duration = Duration::from_millis(10);

/// The parameters of the tests: a torque scale that leaves the default torque limit a duty.
pub const BENCH: [(&str, ParameterValue); 2] =
    [("sample_source", ParameterValue::U32(1)), ("torque_per_duty_nm", ParameterValue::F32(100.0))];

/// Names of the parameters, by their indices: all images with bench mode have the same.
static PARAMETERS: OnceLock<Vec<String>> = OnceLock::new();

/// A host of a drive on virtual silicon.
pub struct Host {
    pub bench: Bench,
    decoder: Decoder,
    /// Messages that no test has taken.
    inbox: Vec<DriveMessage>,
    number: u16,
    /// Control period of the drive, as [`Self::set_all`] sets it.
    pub period: Duration,
    /// Whether the drive may end a frame before its end, as a handler of a fatal failure does.
    pub expects_cut_frame: bool,
}

impl Host {
    /// A host of a drive in a session, with encoders at these counts.
    pub fn at(image: &Symbols, counts: (i64, i64)) -> Self {
        Self::of(Bench::power_up(image, counts))
    }

    /// A host of this board, in a session.
    pub fn of(mut bench: Bench) -> Self {
        bench.advance(BOOT);
        let mut host = Self {
            bench,
            decoder: Decoder::new(),
            inbox: Vec::new(),
            number: 0,
            period: Duration::from_millis(1),
            expects_cut_frame: false,
        };
        host.shake_hands(SESSION);
        host
    }

    /// Names of the parameters, by their indices.
    pub fn names(&mut self) -> Vec<String> {
        let count = self.shake_hands(SESSION).parameter_count;
        (0..count).map(|index| self.name_of(index)).collect()
    }

    fn name_of(&mut self, index: u8) -> String {
        self.exchange(DescribeParameter { index }, |message| match message {
            DriveMessage::ParameterDescription(it) => Some(it.name.as_str().to_owned()),
            _ => None,
        })
    }

    /// A host of an idle drive with the parameters of the tests and then these.
    pub fn idle(image: &Symbols, parameters: &[(&str, ParameterValue)]) -> Self {
        let mut host = Self::at(image, (0, 0));
        host.set_all(parameters);
        host
    }

    /// A host of a drive that runs on its pins with these parameters, and has had no reference.
    pub fn running(image: &Symbols, parameters: &[(&str, ParameterValue)]) -> Self {
        let mut host = Self::idle(image, parameters);
        host.run();
        host
    }

    /// As [`Self::running`], with this period and with steps under torque.
    pub fn under_torque(image: &Symbols, period: Duration) -> Self {
        let mut host = Self::at(image, (0, 0));
        host.period = period;
        host.set_all(&[]);
        host.run_under_torque();
        host
    }

    pub fn run_under_torque(&mut self) {
        self.run();
        let samples = self.steps(5, 1.0);
        let faults = self.faults();
        assert_ne!(samples.last().expect("samples").torque_nm, 0.0, "{faults:?}, {samples:?}");
        assert!(self.bench.bridge().is_on());
    }

    pub fn set_all(&mut self, parameters: &[(&str, ParameterValue)]) {
        let period_us = self.period.as_micros() as u32;
        // The line carries a sample in every millisecond.
        let periods = [("period_us", period_us), ("bench_sample_every", (1_000 / period_us).max(1))];
        let periods = periods.map(|(name, value)| (name, ParameterValue::U32(value)));
        for (name, value) in BENCH.iter().chain(&periods).chain(parameters) {
            assert_eq!(self.set(name, *value), Outcome::Accepted, "{name}");
        }
    }

    pub fn run(&mut self) {
        assert_eq!(self.arm(), (Outcome::Accepted, State::Armed));
        assert_eq!(self.start(), (Outcome::Accepted, State::Running));
    }

    pub fn shake_hands(&mut self, session: u32) -> Identity {
        self.exchange(Hello::new(session), |message| match message {
            DriveMessage::Identity(identity) => Some(*identity),
            _ => None,
        })
    }

    pub fn arm(&mut self) -> (Outcome, State) {
        self.command(Arm { session: SESSION })
    }

    pub fn start(&mut self) -> (Outcome, State) {
        self.command(Start { session: SESSION })
    }

    /// Index of the parameter of this name.
    pub fn index(&mut self, name: &str) -> u8 {
        let index = PARAMETERS.get_or_init(|| self.names()).iter().position(|it| it == name);
        index.unwrap_or_else(|| panic!("no parameter {name}")) as u8
    }

    pub fn set(&mut self, name: &str, value: ParameterValue) -> Outcome {
        let index = self.index(name);
        self.exchange(SetParameter { index, value }, |message| match message {
            DriveMessage::ParameterReport(report) if report.index == index => Some(report.outcome),
            _ => None,
        })
    }

    /// Sends a request and returns its result.
    pub fn command(&mut self, message: impl Into<HostMessage>) -> (Outcome, State) {
        self.exchange(message, |message| match message {
            DriveMessage::CommandResult(result) => Some((result.outcome, result.state)),
            _ => None,
        })
    }

    /// Outcome and detail of an `Arm` that the drive refuses.
    pub fn refusal_to_arm(&mut self) -> (Outcome, u32) {
        self.exchange(Arm { session: SESSION }, |message| match message {
            DriveMessage::CommandResult(it) => {
                assert_eq!(it.state, State::Idle);
                Some((it.outcome, it.detail))
            }
            _ => None,
        })
    }

    /// Sends a request and waits for the message that `wanted` takes. All others stay in the inbox.
    pub fn exchange<T>(
        &mut self,
        message: impl Into<HostMessage>,
        wanted: impl Fn(&DriveMessage) -> Option<T>,
    ) -> T {
        let message = message.into();
        // Results of references that were refused.
        self.take(|message| matches!(message, DriveMessage::CommandResult(_)).then_some(()));
        let due = self.send(message) + ANSWER;
        loop {
            self.receive();
            if let Some(place) = self.inbox.iter().position(|message| wanted(message).is_some()) {
                return wanted(&self.inbox.remove(place)).expect("as before");
            }
            assert!(self.bench.now() < due, "no answer to {message:?}, but {:?}", self.inbox);
            self.bench.advance_to_frame(due);
        }
    }

    /// Sends a message. Returns the device time at which the chip has received its last byte.
    pub fn send(&mut self, message: impl Into<HostMessage>) -> Duration {
        let frame = message.into().frame();
        let bytes = frame.to_vec();
        let waiting = self.bench.act(move |chip, _| {
            let line = chip.serial_line();
            line.send(&bytes);
            line.unsent()
        });
        self.bench.now() + BYTE * u32::try_from(waiting).expect("a short frame")
    }

    /// Sends the next reference. Returns the device time at which the chip has received it.
    pub fn refer(&mut self, reference_rad: f32) -> Duration {
        self.number = self.number.wrapping_add(1);
        self.send(Reference { number: self.number, reference_rad })
    }

    /// Runs the drive for some milliseconds with a reference in each. Returns the samples.
    pub fn steps(&mut self, milliseconds: u32, reference_rad: f32) -> Vec<BenchSample> {
        for _ in 0..milliseconds {
            self.refer(reference_rad);
            self.bench.advance(Duration::from_millis(1));
        }
        self.samples()
    }

    /// Takes the samples that have arrived.
    pub fn samples(&mut self) -> Vec<BenchSample> {
        self.take(|message| match message {
            DriveMessage::BenchSample(sample) => Some(*sample),
            _ => None,
        })
    }

    /// Takes the fault reports that have arrived.
    pub fn faults(&mut self) -> Vec<FaultReport> {
        self.take(|message| match message {
            DriveMessage::FaultReport(report) => Some(*report),
            _ => None,
        })
    }

    /// Takes all messages of a kind that have arrived.
    pub fn take<T>(&mut self, wanted: impl Fn(&DriveMessage) -> Option<T>) -> Vec<T> {
        self.receive();
        let (taken, others) = self.inbox.drain(..).partition(|message| wanted(message).is_some());
        self.inbox = others;
        let taken: Vec<DriveMessage> = taken;
        taken.iter().filter_map(wanted).collect()
    }

    fn receive(&mut self) {
        let bytes = self.bench.act(|chip, _| chip.serial_line().take());
        let mut rest = &bytes[..];
        while let Some(message) = self.decoder.next(&mut rest) {
            match message {
                Ok(it) => self.inbox.push(it.message),
                Err(error) => assert!(self.expects_cut_frame, "{error}"),
            }
        }
    }
}
