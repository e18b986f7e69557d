//! The drive as its owner sees it: bytes and device time in, bytes and a torque out.

use core::time::Duration;

use lashloop_protocol::enums::{Capabilities, FaultCode, LogLevel, Outcome, State, TorqueFlags};
use lashloop_protocol::layout::has_number;
use lashloop_protocol::message::{self, CommandResult, EncoderSample, FaultReport, Hello};
use lashloop_protocol::wire::{BodyError, Payload};
use lashloop_protocol::{
    Counters, Decoder, DriveMessage, FrameError, HostMessage, Numbered, PROTOCOL_VERSION,
};

use super::clock::Clock;
use super::descriptions;
use super::identity::identity;
use super::keep::Keep;
use super::lifecycle::Lifecycle;
use super::line_counts::LineCounts;
use super::loader::Loader;
use super::output::Output;
use super::parameters::Parameters;
use super::pins::{PinHardware, Pins};
use super::refusal::Refusal;
use super::run::{Reply, Run};
use super::safety::Violation;
use super::scope::{Captured, Scope};
use super::subscription::Subscription;
use super::torque_answer::torque_answer;
use crate::law::LawSet;
use crate::laws::Laws;
use crate::store::Store;

/// The state machine of a drive with these laws.
pub struct Drive<L: LawSet = Laws> {
    board: &'static str,
    decoder: Decoder,
    pub(super) output: Output,
    pub(super) parameters: Parameters<L>,
    pub(super) subscription: Subscription,
    pub(super) scope: Scope,
    pub(super) lifecycle: Lifecycle<L>,
    line_counts: LineCounts,
    /// Number of the last sample taken, for fault reports after the run too; 0 before the first sample of a run.
    pub(super) last_sequence: u16,
    /// `None` for a drive without encoders and power stage of its own: it has no bench mode.
    pub(super) pins: Option<Pins>,
    pub(super) loader: Loader,
    /// `None` for a drive whose parameters don't survive power-off.
    pub(super) store: Option<Store>,
    /// The request for the store that is being answered.
    pub(super) keeping: Keep,
}

impl Drive {
    /// A drive with Lashloop's own laws, see [`Self::with_laws`].
    #[must_use]
    pub fn new(board: &'static str) -> Self {
        Self::with_laws(board)
    }
}

impl<L: LawSet> Drive<L> {
    /// A drive after power-up: disarmed, with default parameters, without telemetry. `board` is the name of the board, at
    /// most 16 bytes.
    #[must_use]
    pub fn with_laws(board: &'static str) -> Self {
        Self::of(board, None)
    }

    /// As [`Self::with_laws`], with encoders and a power stage of its own: bench mode is offered.
    #[must_use]
    pub fn with_pins(board: &'static str, hardware: PinHardware) -> Self {
        Self::of(board, Some(hardware))
    }

    fn of(board: &'static str, hardware: Option<PinHardware>) -> Self {
        Self {
            board,
            decoder: Decoder::new(),
            output: Output::default(),
            parameters: Parameters::new(hardware.is_some()),
            subscription: Subscription::default(),
            scope: Scope::default(),
            lifecycle: Lifecycle::Boot,
            line_counts: LineCounts::default(),
            last_sequence: 0,
            pins: hardware.map(Pins::new),
            loader: Loader::Absent,
            store: None,
            keeping: Keep::Recall,
        }
    }

    /// Takes received bytes, at most to the end of one frame, and returns their number.
    ///
    /// Zero for a non-empty input means that the output buffer is full: transmit [`Drive::output`], clear it, and call
    /// again with the remaining bytes. So it is while [`Drive::continue_storing`] has something to write.
    pub fn receive(&mut self, bytes: &[u8], clock: &impl Clock) -> usize {
        if self.loader.is_requested() {
            return bytes.len();
        }
        if !self.output.fits_an_answer() || self.store.as_ref().is_some_and(Store::is_writing) {
            return 0;
        }
        let mut rest = bytes;
        match self.decoder.next::<HostMessage>(&mut rest) {
            // Its time counts from here, so nothing of a request is done before.
            Some(Ok(Numbered { message: HostMessage::EncoderSample(sample), .. })) => {
                self.answer_sample(&sample, clock);
            }
            Some(Ok(Numbered { number, message })) => {
                let arrived = clock.now();
                self.output.begin_answer(number, arrived);
                self.handle(&message, arrived);
            }
            // A request that a newer minor version added. What a host sends in every period gets no answer.
            Some(Err(FrameError::Body(BodyError::UnknownKind { kind, number }))) if has_number(kind) => {
                self.output.begin_answer(number, clock.now());
                self.refuse(kind, Outcome::UnknownRequest);
            }
            // A damaged frame is handled as a missing one: the decoder counts it, and the host times out.
            Some(Err(_)) | None => {}
        }
        bytes.len() - rest.len()
    }

    /// Checks the watchdog at device time `now`; in bench mode the ticks too.
    pub fn tick(&mut self, now: Duration) {
        if let Err(violation) = self.lifecycle.check_time(now) {
            let fault = self.latch(violation, now);
            self.output.send_later(fault);
        }
    }

    /// Device time after which [`Drive::tick`] trips the watchdog; `None` unless running.
    #[must_use]
    pub fn next_tick(&self) -> Option<Duration> {
        self.lifecycle.run().map(|run| run.watchdog().deadline())
    }

    /// The bytes to transmit. Encodes a fault report that a tick has left.
    #[must_use]
    pub fn output(&mut self) -> &[u8] {
        self.output.bytes()
    }

    /// Whether there are bytes to transmit. Cheaper than [`Self::output`], for a task that must end soon.
    #[must_use]
    pub fn has_output(&self) -> bool {
        !self.output.is_empty()
    }

    /// Clears the output after its transmission.
    pub fn clear_output(&mut self) {
        self.output.clear();
    }

    /// The held torque in N m. Zero unless running.
    #[must_use]
    pub fn torque_nm(&self) -> f32 {
        self.lifecycle.run().map_or(0.0, Run::torque_nm)
    }

    /// The state reported on the wire.
    #[must_use]
    pub fn state(&self) -> State {
        self.lifecycle.state()
    }

    /// What the decoder has counted since power-up.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        self.decoder.counters()
    }

    /// Sends the pieces as one log line, unless it would displace an answer.
    ///
    /// Pieces and no format: formatting would cost the image more flash than the control laws.
    pub fn log(&mut self, level: LogLevel, pieces: &[&str]) {
        self.output.log(level, pieces);
    }

    /// Adds `count` bytes lost by the hardware (overrun, framing) to the next line report.
    pub fn note_overruns(&mut self, count: u32) {
        self.line_counts.add_overruns(count);
    }

    /// Answers any request but a sample.
    fn handle(&mut self, message: &HostMessage, arrived: Duration) {
        let state = self.state();
        let (request, result) = match message {
            HostMessage::EncoderSample(_) => return,
            HostMessage::Reference(reference) => return self.take_reference(reference, arrived),
            HostMessage::Hello(hello) => return self.answer_hello(hello),
            HostMessage::DescribeParameter(request) => {
                return self.output.send(self.parameters.describe(request.index, state, self.store.as_ref()));
            }
            HostMessage::GetParameter(request) => {
                return self.output.send(self.parameters.get(request.index, state));
            }
            HostMessage::SetParameter(request) => {
                let control = self.lifecycle.control();
                let update = control.map(|control| |words: &L::Words| control.update(words));
                let report = self.parameters.set(request, state, update);
                return self.output.send(report);
            }
            HostMessage::DescribeLaw(request) => {
                let description = descriptions::law(L::NAMES, request.index);
                return self.send_description(message::DescribeLaw::LAYOUT.kind, description);
            }
            HostMessage::DescribeSignal(request) => {
                let description = descriptions::signal(L::SIGNALS, request.index);
                return self.send_description(message::DescribeSignal::LAYOUT.kind, description);
            }
            HostMessage::DescribeChoice(request) => {
                let description = self.parameters.describe_choice(request.parameter, request.choice);
                return self.send_description(message::DescribeChoice::LAYOUT.kind, description);
            }
            HostMessage::Subscribe(request) => (message::Subscribe::LAYOUT.kind, self.subscribe(request)),
            HostMessage::Arm(request) => (message::Arm::LAYOUT.kind, self.arm(request.session)),
            HostMessage::Start(request) => {
                (message::Start::LAYOUT.kind, self.start(request.session, arrived))
            }
            HostMessage::EnterLoader(request) => {
                let result = self.enter_loader(request.session, arrived);
                (message::EnterLoader::LAYOUT.kind, result.map_err(Refusal::from))
            }
            HostMessage::StoreParameters(_) => return self.keep_parameters(Keep::Store),
            HostMessage::RecallParameters(_) => return self.keep_parameters(Keep::Recall),
            HostMessage::ForgetParameters(_) => return self.keep_parameters(Keep::Forget),
            HostMessage::SetZero(request) => (message::SetZero::LAYOUT.kind, self.set_zero(request.source)),
            HostMessage::Capture(request) => (message::Capture::LAYOUT.kind, self.capture(request)),
            HostMessage::ReadCapture(request) => match self.read_capture(request.first) {
                Ok(rows) => return self.output.send(rows),
                Err(refusal) => (message::ReadCapture::LAYOUT.kind, Err(refusal)),
            },
            HostMessage::Stop(_) => {
                self.output.send(self.line_counts.report(self.decoder.counters()));
                (message::Stop::LAYOUT.kind, self.lifecycle.stop().map_err(Refusal::from))
            }
            HostMessage::EmergencyStop(_) => {
                let code = FaultCode::EmergencyStop;
                let fault = self.latch(Violation::of(code), arrived);
                self.output.send(fault);
                (message::EmergencyStop::LAYOUT.kind, Ok(()))
            }
            HostMessage::ClearFault(_) => {
                (message::ClearFault::LAYOUT.kind, self.lifecycle.clear_fault().map_err(Refusal::from))
            }
            HostMessage::Reset(_) => {
                self.reset();
                (message::Reset::LAYOUT.kind, Ok(()))
            }
        };
        self.send_result(request, result);
    }

    fn reset(&mut self) {
        self.lifecycle = Lifecycle::Boot;
        self.parameters.recall(self.store.as_ref());
        self.subscription = Subscription::default();
        self.scope.set(Captured::Off);
        self.last_sequence = 0;
        if let Some(pins) = &mut self.pins {
            pins.reset();
        }
    }

    fn answer_hello(&mut self, hello: &Hello) {
        let same_version = hello.protocol_version == PROTOCOL_VERSION;
        if same_version {
            self.lifecycle.open_session(hello.session);
        }
        // A host of another version gets the identity too: it carries the version of the drive.
        let parameters = self.parameters.drive();
        self.output.send(identity::<L>(
            self.board,
            hello.session,
            self.state(),
            &parameters,
            self.parameters.count(),
            self.capabilities(),
        ));
        if let Some(fault) = self.lifecycle.fault() {
            self.output.send(fault);
        }
        if !same_version {
            self.refuse(Hello::LAYOUT.kind, Outcome::VersionMismatch);
        }
    }

    fn capabilities(&self) -> Capabilities {
        let mut capabilities = Capabilities::DEVICE_TIME | Capabilities::CAPTURE;
        capabilities.set(Capabilities::BENCH_MODE, self.pins.is_some());
        capabilities.set(Capabilities::LOADER, self.loader != Loader::Absent);
        capabilities.set(Capabilities::STORE, self.store.is_some());
        capabilities
    }

    /// Counts of the line and samples of a run begin anew.
    pub(super) fn begin_counts(&mut self) {
        self.line_counts = LineCounts::starting_at(self.decoder.counters());
        self.last_sequence = 0;
    }

    fn answer_sample(&mut self, sample: &EncoderSample, clock: &impl Clock) {
        let arrived = clock.now();
        // A sample after the watchdog's deadline is too late, even if `tick` was not called in between. Its torque
        // precedes the fault report.
        let late = self.lifecycle.check_time(arrived).err().map(|violation| self.latch(violation, arrived));
        match &mut self.lifecycle {
            Lifecycle::Boot => self.refuse_sample(Outcome::WrongState, arrived),
            Lifecycle::Idle { .. } | Lifecycle::Armed { .. } | Lifecycle::Faulted { .. } => {
                self.send_zero_torque(sample.sequence, TorqueFlags::empty(), arrived, clock);
            }
            Lifecycle::Running { run, .. } => match run.answer(sample, arrived, clock) {
                Reply::Torque(answer) => {
                    self.last_sequence = sample.sequence;
                    self.output.send(answer);
                    self.observe(sample.sequence, None);
                }
                Reply::Repeated(answer) => self.output.send(answer),
                Reply::OutOfSequence => self.refuse_sample(Outcome::OutOfSequence, arrived),
                Reply::OfPins => self.refuse_sample(Outcome::WrongState, arrived),
                Reply::Violation(violation, flags) => {
                    self.last_sequence = sample.sequence;
                    self.observe(sample.sequence, Some(&violation));
                    let fault = self.latch(violation, arrived);
                    self.send_zero_torque(sample.sequence, flags, arrived, clock);
                    self.output.send(fault);
                }
            },
        }
        if let Some(fault) = late {
            self.output.send(fault);
        }
    }

    fn refuse_sample(&mut self, outcome: Outcome, arrived: Duration) {
        self.output.begin_answer(0, arrived);
        self.refuse(EncoderSample::LAYOUT.kind, outcome);
    }

    /// The torque is zero from here on; the caller sends the report after the answer that is due. `now` is not the due time of a
    /// step: an answer may have been sent since.
    // Never inlined: a fault costs the image its code once.
    #[inline(never)]
    pub(super) fn latch(&mut self, violation: Violation, now: Duration) -> FaultReport {
        self.output.note_time(now);
        let Violation { code, value, limit, detail } = violation;
        let sequence = self.last_sequence;
        let report = FaultReport { code, sequence, value, limit, detail, device_time_us: None };
        self.scope.fault();
        self.lifecycle.latch(report);
        report
    }

    fn send_zero_torque(&mut self, sequence: u16, flags: TorqueFlags, arrived: Duration, clock: &impl Clock) {
        let elapsed = clock.now().saturating_sub(arrived);
        self.output.send(torque_answer(sequence, 0.0, self.state(), flags, elapsed));
    }

    /// Sends a description, or the result of the request of this kind if there is none.
    fn send_description(&mut self, request: u8, description: Option<DriveMessage>) {
        match description {
            Some(description) => self.output.send(description),
            None => self.refuse(request, Outcome::UnknownIndex),
        }
    }

    /// Refuses a request of this kind, with nothing more to say.
    pub(super) fn refuse(&mut self, request: u8, outcome: Outcome) {
        self.send_result(request, Err(outcome.into()));
    }

    /// Sends the result of a request of this kind, which has no answer of its own.
    pub(super) fn send_result(&mut self, request: u8, result: Result<(), Refusal>) {
        let Refusal { outcome, detail } = Refusal::of(result);
        let state = self.state();
        self.output.send(CommandResult { request, outcome, state, detail, device_time_us: None });
    }
}
