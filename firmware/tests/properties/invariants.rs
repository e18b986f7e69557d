//! A drive under watch: after everything that happens to it, all it promises is checked. Property tests and fuzzer
//! share it.

use std::time::Duration;

use lashloop_firmware::drive::parameters::{Parameters, TABLE};
use lashloop_firmware::drive::{Clock, Drive, ManualClock};
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{CommandResult, EncoderSample, FaultReport, ParameterReport, Reset};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{
    Decoder, DriveMessage, EncoderCounts, HostMessage, Message, PROTOCOL_VERSION, cobs, crc,
};

use crate::action::Action;

/// A drive, what we know it has been told, and what it said last.
pub struct Watched {
    drive: Drive,
    clock: ManualClock,
    /// Reads the bytes the drive takes.
    ear: Decoder,
    /// Bytes of the output that have been looked at.
    heard: usize,
    torque_limit_nm: f32,
    /// The one that is latched.
    fault: Option<FaultReport>,
    next_sample: EncoderSample,
    /// What was met on the way.
    pub seen: Seen,
}

/// How far a history came; a watch that sees nothing proves nothing.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// States it was in.
    pub states: Vec<State>,
    /// Faults it latched.
    pub faults: Vec<FaultCode>,
    /// Outcomes it told.
    pub outcomes: Vec<Outcome>,
    /// Torques other than zero it gave.
    pub torques: usize,
    /// Times it took nothing before its output was cleared.
    pub full: usize,
}

/// Why a state may change.
enum Cause {
    Told(HostMessage),
    /// Time passed, or bytes came that are no message.
    Nothing,
}

impl Watched {
    /// A drive that has just been powered.
    pub fn new() -> Self {
        Self {
            drive: Drive::new("watched"),
            clock: ManualClock::default(),
            ear: Decoder::new(),
            heard: 0,
            torque_limit_nm: Parameters::default().torque_limit_nm,
            fault: None,
            next_sample: EncoderSample {
                sequence: 0,
                motor_counts: EncoderCounts::default(),
                load_counts: EncoderCounts::default(),
                reference_rad: 0.0,
            },
            seen: Seen::default(),
        }
    }

    /// Lets it happen.
    ///
    /// # Panics
    /// If the drive breaks a promise.
    pub fn act(&mut self, action: &Action) {
        match action {
            Action::Line(bytes) => self.offer(bytes),
            Action::Body(body) => self.offer(&frame_around(body)),
            Action::Sample { motor, load, reference_rad } => {
                let sample = &mut self.next_sample;
                sample.motor_counts = sample.motor_counts.wrapping_add((*motor).into());
                sample.load_counts = sample.load_counts.wrapping_add((*load).into());
                sample.reference_rad = *reference_rad;
                let frame = HostMessage::from(*sample).frame();
                self.offer(&frame);
            }
            Action::Pass(time) => self.pass(*time),
            Action::Overruns(count) => self.drive.note_overruns((*count).into()),
            Action::Drain => self.drain(),
        }
    }

    fn offer(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let before = self.drive.state();
            let used = self.drive.receive(bytes, &self.clock);
            assert!(used <= bytes.len());
            let (mut taken, rest) = bytes.split_at(used);
            bytes = rest;
            if used == 0 {
                assert!(!self.drive.output().is_empty(), "stalled with nothing left to send");
                self.seen.full += 1;
                self.drain();
                continue;
            }
            let message = self.ear.next::<HostMessage>(&mut taken);
            assert!(taken.is_empty(), "takes one frame at a time");
            assert_eq!(self.drive.counters(), self.ear.counters());
            let cause = match message {
                Some(Ok(message)) => Cause::Told(message),
                Some(Err(_)) | None => Cause::Nothing,
            };
            self.look(before, &cause);
        }
    }

    fn pass(&mut self, time: Duration) {
        let (before, due) = (self.drive.state(), self.drive.next_tick());
        assert_eq!(due.is_some(), before == State::Running, "ticks are asked for while running");
        self.clock.advance(time);
        self.drive.tick(self.clock.now());
        self.look(before, &Cause::Nothing);
        if due.is_some_and(|due| self.clock.now() > due) {
            assert_eq!(self.drive.state(), State::Faulted, "the watchdog trips");
        }
    }

    fn drain(&mut self) {
        self.drive.clear_output();
        self.heard = 0;
        assert!(self.drive.output().is_empty());
    }

    /// Everything promised, after something happened in the state `before`.
    fn look(&mut self, before: State, cause: &Cause) {
        let after = self.drive.state();
        let said = self.listen();
        if after != State::Faulted {
            self.fault = None;
        }
        assert!(may_change(before, after, cause), "{before:?} became {after:?}, having said {said:?}");
        if let Cause::Told(message) = cause {
            assert!(!said.is_empty(), "no answer to {message:?} in {before:?}");
            self.note_told(message, after);
            self.check_told(message, before, after, &said);
        }
        for message in &said {
            self.check_said(message, after);
        }
        if after == State::Faulted && before != State::Faulted {
            let report = said.iter().any(|message| matches!(message, DriveMessage::FaultReport(_)));
            assert!(report, "a fault is told: {said:?}");
        }
        self.check_torque(self.drive.torque_nm(), after);
        self.seen.torques += usize::from(self.drive.torque_nm() != 0.0);
        if !self.seen.states.contains(&after) {
            self.seen.states.push(after);
        }
    }

    /// The new part of the output: whole frames and nothing else.
    fn listen(&mut self) -> Vec<DriveMessage> {
        let mut new = &self.drive.output()[self.heard..];
        self.heard = self.drive.output().len();
        let mut decoder = Decoder::new();
        let said =
            std::iter::from_fn(|| decoder.next(&mut new)).map(|item| item.expect("a good frame")).collect();
        decoder.finish().expect("whole frames");
        said
    }

    fn note_told(&mut self, message: &HostMessage, after: State) {
        match message {
            HostMessage::Start(_) if after == State::Running => self.next_sample.sequence = 0,
            HostMessage::EncoderSample(sample) if after == State::Running => {
                self.next_sample.sequence = sample.sequence.wrapping_add(1);
            }
            _ => {}
        }
    }

    fn check_told(&self, message: &HostMessage, before: State, after: State, said: &[DriveMessage]) {
        match message {
            HostMessage::EncoderSample(sample) => {
                let answered = match said[0] {
                    DriveMessage::TorqueAnswer(answer) => answer.sequence == sample.sequence,
                    DriveMessage::CommandResult(_) => matches!(before, State::Boot | State::Running),
                    _ => false,
                };
                assert!(answered, "the answer comes first: {sample:?} in {before:?}: {said:?}");
            }
            HostMessage::Hello(hello)
                if hello.protocol_version == PROTOCOL_VERSION && after == State::Faulted =>
            {
                let told_again = said.iter().any(|message| match (message, self.fault) {
                    (DriveMessage::FaultReport(report), Some(fault)) => same(report, &fault),
                    _ => false,
                });
                assert!(told_again, "a greeting host learns of the latched fault: {said:?}");
            }
            _ => {}
        }
    }

    fn check_said(&mut self, message: &DriveMessage, state: State) {
        match message {
            DriveMessage::TorqueAnswer(answer) => {
                assert_eq!(answer.status.state, state);
                self.check_torque(answer.torque_nm, state);
                assert_eq!(
                    answer.torque_nm.to_bits(),
                    self.drive.torque_nm().to_bits(),
                    "what is told is given"
                );
            }
            DriveMessage::FaultReport(report) => {
                assert_eq!(state, State::Faulted);
                // The first one is kept until it is cleared.
                self.fault.get_or_insert(*report);
                if !self.seen.faults.contains(&report.code) {
                    self.seen.faults.push(report.code);
                }
            }
            DriveMessage::ParameterReport(report) => self.note_parameter(report),
            DriveMessage::CommandResult(result) => {
                self.note_outcome(result.outcome);
                let reset = CommandResult { request: Reset::LAYOUT.kind, outcome: Outcome::Accepted, state };
                if *result == reset {
                    self.torque_limit_nm = Parameters::default().torque_limit_nm;
                }
            }
            _ => {}
        }
    }

    fn note_parameter(&mut self, report: &ParameterReport) {
        self.note_outcome(report.outcome);
        let Some(entry) = TABLE.get(usize::from(report.index)) else {
            assert_eq!(report.outcome, Outcome::UnknownParameter);
            return;
        };
        assert!(in_range(report.value, entry.min, entry.max), "{} = {:?}", entry.name, report.value);
        if let ("torque_limit_nm", ParameterValue::F32(limit)) = (entry.name, report.value) {
            self.torque_limit_nm = limit;
        }
    }

    fn note_outcome(&mut self, outcome: Outcome) {
        if !self.seen.outcomes.contains(&outcome) {
            self.seen.outcomes.push(outcome);
        }
    }

    fn check_torque(&self, torque_nm: f32, state: State) {
        assert!(torque_nm.is_finite(), "{torque_nm} N m");
        assert!(torque_nm.abs() <= self.torque_limit_nm, "{torque_nm} N m of {} N m", self.torque_limit_nm);
        assert!(torque_nm == 0.0 || state == State::Running, "{torque_nm} N m in {state:?}");
    }
}

/// The arrows of the state diagram.
fn may_change(before: State, after: State, cause: &Cause) -> bool {
    use HostMessage as Told;
    use State::{Armed, Boot, Faulted, Idle, Running};
    match (before, after, cause) {
        (_, Boot, Cause::Told(Told::Reset(_))) | (_, Faulted, Cause::Told(Told::EmergencyStop(_))) => true,
        (_, _, Cause::Told(Told::Reset(_) | Told::EmergencyStop(_))) => false,
        (Faulted, Idle | Boot, Cause::Told(Told::ClearFault(_))) => true,
        (Faulted, _, Cause::Told(Told::ClearFault(_))) => false,
        (Running, Faulted, Cause::Nothing | Cause::Told(Told::EncoderSample(_))) => true,
        (Armed | Running, Idle, Cause::Told(Told::Stop(_) | Told::Hello(_))) => true,
        (Boot, Idle, Cause::Told(Told::Hello(_))) => true,
        (Idle, Armed, Cause::Told(Told::Arm(_))) => true,
        (Armed, Running, Cause::Told(Told::Start(_))) => true,
        _ => before == after,
    }
}

fn in_range(value: ParameterValue, min: ParameterValue, max: ParameterValue) -> bool {
    match (value, min, max) {
        (ParameterValue::U32(value), ParameterValue::U32(min), ParameterValue::U32(max)) => {
            (min..=max).contains(&value)
        }
        (ParameterValue::F32(value), ParameterValue::F32(min), ParameterValue::F32(max)) => {
            (min..=max).contains(&value)
        }
        _ => false,
    }
}

/// Equal in every bit: a fault may carry NaN.
fn same(a: &FaultReport, b: &FaultReport) -> bool {
    DriveMessage::from(*a).frame()[..] == DriveMessage::from(*b).frame()[..]
}

/// The frame around any body, with a right CRC.
pub fn frame_around(body: &[u8]) -> Vec<u8> {
    let mut frame = [&[0], body, &crc::checksum(body).to_le_bytes()].concat();
    cobs::stuff(&mut frame);
    frame.push(0);
    frame
}
