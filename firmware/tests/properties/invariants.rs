//! A drive whose invariants are checked after every action, for property tests and fuzzer.

use std::time::Duration;

use lashloop_firmware::Laws;
use lashloop_firmware::drive::{Clock, Drive, ManualClock};
use lashloop_firmware::law::{DriveParameters, LawSet};
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::layout::has_number;
use lashloop_protocol::message::{
    Arm, EmergencyStop, EncoderSample, FaultReport, Hello, ParameterReport, Reset, Start, Subscribe,
    Telemetry,
};
use lashloop_protocol::wire::{BodyError, Payload};
use lashloop_protocol::{
    Decoder, DriveMessage, EncoderCounts, Frame, FrameError, HostMessage, Message, Numbered, PROTOCOL_VERSION,
};

use crate::action::Action;
use crate::transitions::{Cause, may_change};

/// A drive, and what its requests and answers imply about it.
pub struct CheckedDrive<O = ()> {
    drive: Drive,
    clock: ManualClock,
    /// Decodes the bytes that the drive takes.
    decoder: Decoder,
    /// Bytes of the output already checked.
    checked_bytes: usize,
    torque_limit_nm: f32,
    /// What the drive has accepted.
    subscription: Subscribe,
    /// The latched fault.
    fault: Option<FaultReport>,
    next_sample: EncoderSample,
    /// Number of the last request.
    number: u8,
    /// What the history reached.
    pub observer: O,
}

/// What happened to a drive, for those who measure what a history reached. A fuzzer doesn't: `()`.
pub trait Observer {
    /// Bytes were taken, or time elapsed.
    fn step(&mut self, _step: &Step<'_>) {}
    /// The drive took no byte, because its output buffer was full.
    fn stall(&mut self) {}
}

impl Observer for () {}

/// One step of a drive.
pub struct Step<'drive> {
    /// State before.
    pub before: State,
    /// What was received.
    pub cause: &'drive Cause,
    /// State afterwards.
    pub after: State,
    /// What the drive sent.
    pub sent: &'drive [DriveMessage],
    /// Its torque afterwards, in N m.
    pub torque_nm: f32,
}

/// Most messages that one action of the drive sends.
const MOST_SENT: usize = 3;
type Sent = heapless::Vec<DriveMessage, MOST_SENT>;

const NO_TELEMETRY: Subscribe = Subscribe { signals: 0, every: 0 };

impl<O: Observer + Default> CheckedDrive<O> {
    /// A drive after power-up.
    pub fn new() -> Self {
        Self {
            drive: Drive::new("checked"),
            clock: ManualClock::default(),
            decoder: Decoder::new(),
            checked_bytes: 0,
            torque_limit_nm: DriveParameters::default().torque_limit_nm,
            subscription: NO_TELEMETRY,
            fault: None,
            next_sample: EncoderSample {
                sequence: 0,
                motor_counts: EncoderCounts::default(),
                load_counts: EncoderCounts::default(),
                reference_rad: 0.0,
            },
            number: 0,
            observer: O::default(),
        }
    }

    /// Applies one action and checks every invariant.
    ///
    /// # Panics
    /// If the drive violates an invariant.
    pub fn act(&mut self, action: &Action<'_>) {
        match action {
            Action::Line(bytes) => self.receive(bytes),
            Action::Body(body) => self.receive(&Frame::around(body)),
            Action::Sample { motor, load, reference_rad } => {
                let sample = &mut self.next_sample;
                sample.motor_counts = sample.motor_counts.wrapping_add((*motor).into());
                sample.load_counts = sample.load_counts.wrapping_add((*load).into());
                sample.reference_rad = *reference_rad;
                let frame = HostMessage::from(*sample).frame();
                self.receive(&frame);
            }
            Action::Elapse(time) => self.elapse(*time),
            Action::Overruns(count) => self.drive.note_overruns((*count).into()),
            Action::Drain => self.drain(),
            Action::Enter(state) => self.enter(*state),
        }
    }

    fn enter(&mut self, state: State) {
        let way = way_to(state);
        // A drive in `Boot` is as after a reset: it takes no parameter and no subscription there.
        let from_here = if self.drive.state() == State::Boot { &way[1..] } else { way };
        from_here.iter().for_each(|request| self.receive(&request.frame()));
    }

    fn receive(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let before = self.drive.state();
            let used = self.drive.receive(bytes, &self.clock);
            assert!(used <= bytes.len());
            let (mut taken, rest) = bytes.split_at(used);
            bytes = rest;
            if used == 0 {
                assert!(!self.drive.output().is_empty(), "stalled with an empty output buffer");
                self.observer.stall();
                self.drain();
                continue;
            }
            let message = self.decoder.next::<HostMessage>(&mut taken);
            assert!(taken.is_empty(), "takes one frame at a time");
            assert_eq!(self.drive.counters(), self.decoder.counters());
            let (number, cause) = match message {
                Some(Ok(Numbered { number, message })) => (number, Cause::Request(message)),
                Some(Err(FrameError::Body(BodyError::UnknownKind { kind, number }))) => {
                    (number, Cause::UnknownRequest(kind))
                }
                Some(Err(_)) | None => (0, Cause::NoRequest),
            };
            self.number = number;
            self.check(before, &cause);
        }
    }

    fn elapse(&mut self, time: Duration) {
        let (before, due) = (self.drive.state(), self.drive.next_tick());
        assert_eq!(due.is_some(), before == State::Running, "ticks are due while running only");
        self.clock.advance(time);
        self.drive.tick(self.clock.now());
        self.check(before, &Cause::NoRequest);
        if due.is_some_and(|due| self.clock.now() > due) {
            assert_eq!(self.drive.state(), State::Faulted, "the watchdog trips");
        }
    }

    fn drain(&mut self) {
        self.drive.clear_output();
        self.checked_bytes = 0;
        assert!(self.drive.output().is_empty());
    }

    /// Checks every invariant after something happened in the state `before`.
    fn check(&mut self, before: State, cause: &Cause) {
        let after = self.drive.state();
        let sent = self.take_new_output();
        if after != State::Faulted {
            self.fault = None;
        }
        assert!(may_change(before, after, cause), "{before:?} became {after:?}, with {sent:?}");
        match cause {
            Cause::Request(message) => {
                assert!(!sent.is_empty(), "no answer to {message:?} in {before:?}");
                self.note_request(message, after);
                self.check_answers(message, before, after, &sent);
                self.check_telemetry(message, &sent);
            }
            Cause::UnknownRequest(kind) => check_unknown(*kind, &sent),
            Cause::NoRequest => {}
        }
        for message in &sent {
            self.check_message(message, after);
        }
        if after == State::Faulted && before != State::Faulted {
            let report = sent.iter().any(|message| matches!(message, DriveMessage::FaultReport(_)));
            assert!(report, "an unreported fault: {sent:?}");
        }
        self.check_torque(self.drive.torque_nm(), after);
        let torque_nm = self.drive.torque_nm();
        self.observer.step(&Step { before, cause, after, sent: &sent, torque_nm });
    }

    /// The unchecked part of the output, which must be whole frames, with the number of the last request and the present time.
    fn take_new_output(&mut self) -> Sent {
        let output = self.drive.output();
        let mut new = &output[self.checked_bytes..];
        self.checked_bytes = output.len();
        let mut decoder = Decoder::new();
        let sent: heapless::Vec<Numbered<DriveMessage>, MOST_SENT> =
            std::iter::from_fn(|| decoder.next(&mut new)).map(|item| item.expect("a good frame")).collect();
        decoder.finish().expect("whole frames");
        for Numbered { number, message } in &sent {
            let want = if has_number(message.layout().kind) { self.number } else { 0 };
            assert_eq!(*number, want, "{message:?}");
            if let Some(us) = device_time_us(message) {
                assert_eq!(us, self.clock.now().as_micros() as u32, "the device time of {message:?}");
            }
        }
        sent.into_iter().map(|it| it.message).collect()
    }

    fn note_request(&mut self, message: &HostMessage, after: State) {
        match message {
            HostMessage::Start(_) if after == State::Running => self.next_sample.sequence = 0,
            HostMessage::EncoderSample(sample) if after == State::Running => {
                self.next_sample.sequence = sample.sequence.wrapping_add(1);
            }
            _ => {}
        }
    }

    fn check_answers(&self, message: &HostMessage, before: State, after: State, sent: &[DriveMessage]) {
        match message {
            HostMessage::EncoderSample(sample) => {
                let answered = match sent[0] {
                    DriveMessage::TorqueAnswer(answer) => answer.sequence == sample.sequence,
                    DriveMessage::CommandResult(_) => matches!(before, State::Boot | State::Running),
                    _ => false,
                };
                assert!(answered, "the answer comes first: {sample:?} in {before:?}: {sent:?}");
            }
            HostMessage::Hello(hello)
                if hello.protocol_version == PROTOCOL_VERSION && after == State::Faulted =>
            {
                let reported_again = sent.iter().any(|message| match (message, self.fault) {
                    (DriveMessage::FaultReport(report), Some(fault)) => same(report, &fault),
                    _ => false,
                });
                assert!(reported_again, "a handshake reports the latched fault: {sent:?}");
            }
            _ => {}
        }
    }

    /// Telemetry follows the torque of a sample that is due, with one value for each subscribed signal.
    fn check_telemetry(&mut self, request: &HostMessage, sent: &[DriveMessage]) {
        let accepted = sent.iter().any(|message| {
            matches!(message, DriveMessage::CommandResult(result) if result.outcome == Outcome::Accepted)
        });
        match request {
            HostMessage::Subscribe(subscription) if accepted => self.subscription = *subscription,
            HostMessage::Reset(_) => self.subscription = NO_TELEMETRY,
            _ => {}
        }
        for message in sent {
            let DriveMessage::Telemetry(Telemetry { sequence, values }) = message else { continue };
            let Subscribe { signals, every } = self.subscription;
            assert!(
                matches!(sent[0], DriveMessage::TorqueAnswer(answer) if answer.sequence == *sequence),
                "telemetry follows its torque: {sent:?}"
            );
            assert!(every > 0 && sequence % every == 0, "telemetry of {sequence}, every {every}");
            assert_eq!(values.as_slice().len(), signals.count_ones() as usize);
        }
    }

    fn check_message(&mut self, message: &DriveMessage, state: State) {
        match message {
            DriveMessage::TorqueAnswer(answer) => {
                assert_eq!(answer.status.state, state);
                self.check_torque(answer.torque_nm, state);
                assert_eq!(
                    answer.torque_nm.to_bits(),
                    self.drive.torque_nm().to_bits(),
                    "the sent torque is the held torque"
                );
            }
            DriveMessage::FaultReport(report) => {
                assert_eq!(state, State::Faulted);
                // The first fault stays latched until it is cleared.
                self.fault.get_or_insert(*report);
            }
            DriveMessage::ParameterReport(report) => self.note_parameter(report),
            DriveMessage::CommandResult(result)
                if (result.request, result.outcome) == (Reset::LAYOUT.kind, Outcome::Accepted) =>
            {
                self.torque_limit_nm = DriveParameters::default().torque_limit_nm;
            }
            _ => {}
        }
    }

    fn note_parameter(&mut self, report: &ParameterReport) {
        let Some(entry) = Laws::PARAMETERS.get(usize::from(report.index)) else {
            assert_eq!(report.outcome, Outcome::UnknownIndex);
            return;
        };
        assert!(
            in_range(report.value, entry.range.min(), entry.range.max()),
            "{} = {:?}",
            entry.name,
            report.value
        );
        if let ("torque_limit_nm", ParameterValue::F32(limit)) = (entry.name, report.value) {
            self.torque_limit_nm = limit;
        }
    }

    fn check_torque(&self, torque_nm: f32, state: State) {
        assert!(torque_nm.is_finite(), "{torque_nm} N m");
        assert!(torque_nm.abs() <= self.torque_limit_nm, "{torque_nm} N m of {} N m", self.torque_limit_nm);
        assert!(torque_nm == 0.0 || state == State::Running, "{torque_nm} N m in {state:?}");
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

/// The device time of a message in us, if it has the field. A drive that says that it has device time writes it into all of them.
fn device_time_us(message: &DriveMessage) -> Option<u32> {
    { *message }.device_time_us_mut().map(|field| field.expect("a device time"))
}

/// An unknown request has one answer; what a host sends in every period has none.
fn check_unknown(kind: u8, sent: &[DriveMessage]) {
    match sent {
        [] => assert!(!has_number(kind), "no answer to {kind:#04x}"),
        [DriveMessage::CommandResult(it)] if has_number(kind) => {
            assert_eq!((it.request, it.outcome, it.detail), (kind, Outcome::UnknownRequest, 0));
        }
        other => panic!("{other:?}"),
    }
}

/// Bitwise equality but for the time of the report: a fault may carry NaN.
fn same(a: &FaultReport, b: &FaultReport) -> bool {
    let frame = |report: &FaultReport| Frame::of(&FaultReport { device_time_us: None, ..*report });
    frame(a)[..] == frame(b)[..]
}

/// The session of [`Action::Enter`].
pub const SESSION: u32 = 7;

/// The requests that lead to a state from any other.
fn way_to(state: State) -> &'static [HostMessage] {
    const WAY: &[HostMessage] = &[
        HostMessage::Reset(Reset {}),
        HostMessage::Hello(Hello::new(SESSION)),
        HostMessage::Arm(Arm { session: SESSION }),
        HostMessage::Start(Start { session: SESSION }),
        HostMessage::EmergencyStop(EmergencyStop {}),
    ];
    match state {
        State::Boot => &WAY[..1],
        State::Idle => &WAY[..2],
        State::Armed => &WAY[..3],
        State::Running => &WAY[..4],
        State::Faulted | State::Unknown(_) => WAY,
    }
}
