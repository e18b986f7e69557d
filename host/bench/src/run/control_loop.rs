//! One step of the loop: observe the plant, exchange sample and torque, hold the torque for a period.
//!
//! A sample without an answer by its deadline is given up: the last torque is held for that period, as on a real bench,
//! and the step is counted. Nothing here allocates, locks or logs, but the exchange with a plant in a process allocates.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use lashloop_protocol::message::{EncoderSample, TorqueAnswer};

use super::answer_check::AnswerCheck;
use super::error::RunError;
use super::held_torque::HeldTorque;
use super::latched_fault::latched_fault;
use super::outcome::End;
use super::phase::{Phase, Request};
use super::simulator::Simulator;
use super::step::{DriveValues, Observation, Step};
use super::step_sink::StepSink;
use super::waiting_time::WaitingTime;
use super::{reconnect, setup};
use crate::device::Device;
use crate::fault::timeline::Timeline;
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, FrameFault, Way};
use crate::timing::{ClockName, RoundTrip, StepOutcome, StepTiming};
use crate::verdict::AnswerRule;
use lashloop_session::{Exchange, SessionError};

/// The loop of one run.
pub(super) struct ControlLoop<'a, S> {
    pub(super) scenario: &'a Scenario,
    simulator: Simulator,
    pub(super) sink: S,
    pub(super) timeline: Timeline,
    pub(super) clock: ClockName,
    is_timed: bool,
    phase: Phase,
    answers: AnswerCheck,
    torque: HeldTorque,
    /// When the first sample was sent that has no answer yet, in the link's time.
    silent_since: Option<Instant>,
    /// `None` in real time, where the clock bounds every wait, and in a run without times, whose waits are virtual.
    waiting: Option<WaitingTime>,
    pub(super) counts: Counts,
    /// Signals that the drive sends in a telemetry.
    drive_signals: usize,
    /// The last step. Its telemetry follows its torque, so it is complete only with the next one.
    unfinished: Option<Step>,
}

/// What the loop knows of its clock and of the drive.
#[derive(Debug, Clone, Copy)]
pub(super) struct LoopSettings {
    pub(super) clock: ClockName,
    /// Whether the steps have times.
    pub(super) is_timed: bool,
    /// The drive's watchdog in real time; `None` in lockstep.
    pub(super) watchdog: Option<Duration>,
    /// Signals of the plant in the record.
    pub(super) plant_signals: usize,
    /// Signals that the drive sends in a telemetry.
    pub(super) drive_signals: usize,
    /// The drive's largest torque in N m, as read from it.
    pub(super) torque_limit_nm: f32,
    /// Whether the law takes its reference as a torque, not as a position.
    pub(super) takes_torque: bool,
}

/// What the loop counts.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    /// Steps made, missed ones included.
    pub(super) steps: u64,
    /// Samples without a torque by their deadline.
    pub(super) unanswered: u64,
    /// Times that the drive was lost and came back.
    pub(super) resumes: u64,
}

/// How a step continues after its exchange.
type Exchanged = ControlFlow<End, (StepOutcome, Option<RoundTrip>)>;

impl<'a, S: StepSink> ControlLoop<'a, S> {
    /// The loop for a drive that is about to be started.
    pub(super) fn new(
        scenario: &'a Scenario,
        simulator: Simulator,
        timeline: Timeline,
        settings: LoopSettings,
        sink: S,
    ) -> Self {
        let LoopSettings { clock, is_timed, watchdog, drive_signals, torque_limit_nm, .. } = settings;
        let period = Duration::from_micros(scenario.run.control_period_us.into());
        let waiting = || WaitingTime::new(scenario.link.mean_wait(), scenario.link.answer_timeout());
        Self {
            scenario,
            simulator,
            sink,
            timeline,
            clock,
            is_timed,
            phase: Phase::Started,
            answers: AnswerCheck::new(torque_limit_nm, may_duplicate_samples(scenario)),
            torque: HeldTorque::new(period, watchdog),
            silent_since: None,
            waiting: (clock == ClockName::Lockstep && is_timed).then(waiting),
            counts: Counts::default(),
            drive_signals,
            unfinished: None,
        }
    }

    /// Makes a step with an exchange: asks the drive for a torque, at the latest by `deadline`, and holds it for a period.
    /// `lateness` is from the due time of the step to its beginning.
    pub(super) fn step(
        &mut self,
        step: u32,
        deadline: Instant,
        lateness: Duration,
        device: &mut Device,
    ) -> Result<Option<End>, RunError> {
        if let Phase::Restarting = self.phase
            && let Some(end) = self.start_again(device)?
        {
            return Ok(Some(end));
        }
        self.begin(step, device)?;
        let (sample, observation) = self.simulator.observe(step)?;
        let request = self.phase.request(step, sample, &self.simulator)?;
        let sent = request.as_ref().map(|it| it.sample);
        let exchanged = match request {
            Some(request) => self.exchange(step, &request, deadline, device)?,
            // The drive was lost again or started too late: the next step retries the start.
            None => self.give_up(),
        };
        match exchanged {
            ControlFlow::Break(end @ End::RuleBroken(_)) => {
                // The motor gets no torque of such a drive any more, and the record shows it.
                self.torque.torque_nm = 0.0;
                self.finish(device)?;
                let timing = StepTiming {
                    lateness,
                    outcome: StepOutcome::Answered,
                    round_trip: None,
                    tick_compute: None,
                };
                self.hold(step, sent, observation, timing)?;
                Ok(Some(end))
            }
            ControlFlow::Break(end) => Ok(Some(end)),
            ControlFlow::Continue((outcome, round_trip)) => {
                self.finish(device)?;
                let timing = StepTiming { lateness, outcome, round_trip, tick_compute: None };
                self.hold(step, sent, observation, timing)?;
                Ok(None)
            }
        }
    }

    /// Makes a step without an exchange: holds the last torque.
    pub(super) fn miss(&mut self, step: u32, device: &mut Device) -> Result<(), RunError> {
        self.begin(step, device)?;
        let (_, observation) = self.simulator.observe(step)?;
        self.finish(device)?;
        let lateness = Duration::ZERO;
        let outcome = StepOutcome::Missed;
        let timing = StepTiming { lateness, outcome, round_trip: None, tick_compute: None };
        self.hold(step, None, observation, timing)
    }

    /// Passes the last step on, with the drive's latest signals.
    pub(super) fn finish(&mut self, device: &Device) -> Result<(), RunError> {
        let Some(step) = &mut self.unfinished else { return Ok(()) };
        if let Some((telemetry, origin)) = device.session.line.telemetry.zip(self.phase.origin()) {
            step.drive.take(&telemetry, origin, self.scenario.run.control_period_s(), device)?;
        }
        let taken = self.sink.take(step);
        self.unfinished = None;
        taken
    }

    fn begin(&mut self, step: u32, device: &mut Device) -> Result<(), RunError> {
        Ok(self.timeline.begin(step, device).map_err(|source| device.explain(source))?)
    }

    fn exchange(
        &mut self,
        step: u32,
        request: &Request,
        deadline: Instant,
        device: &mut Device,
    ) -> Result<Exchanged, RunError> {
        let sent = device.session.line.now();
        let limit = self.scenario.link.silence_limit();
        let silent_at = self.silent_since.unwrap_or(sent) + limit;
        let Request { number, sample, .. } = request;
        self.answers.note_sent(*number, step);
        let passes = |answer: &TorqueAnswer| self.answers.passes(answer);
        let exchanged = device.session.exchange_checked(*number, sample, deadline.min(silent_at), passes);
        // Of wall-clock time, for a drive in this process waits in virtual time.
        if let Some(waiting) = &mut self.waiting
            && let Ok(Exchange::Answered(_) | Exchange::Unanswered) = exchanged
        {
            let times = device.session.timestamps;
            let waited = times.decoded.saturating_duration_since(times.asked);
            let spent = waiting.spend(waited, || device.connection.host.busy());
            spent.map_err(|source| device.explain(source))?;
        }
        match exchanged {
            Err(source) if source.is_loss() => self.lose(source, device),
            Err(source) => Err(device.explain(source).into()),
            Ok(Exchange::Answered(answer)) => Ok(self.take_answer(request, &answer, deadline, device)),
            Ok(Exchange::Rejected) => self.reject(device),
            Ok(Exchange::Faulted(fault)) => Ok(ControlFlow::Break(End::DriveFault(fault.into()))),
            Ok(Exchange::Unanswered) if device.session.line.now() >= silent_at => {
                let silent = device.session.line.silent("EncoderSample", limit);
                self.lose(silent, device)
            }
            Ok(Exchange::Unanswered) => {
                self.silent_since.get_or_insert(sent);
                Ok(self.give_up())
            }
        }
    }

    fn take_answer(
        &mut self,
        request: &Request,
        answer: &TorqueAnswer,
        deadline: Instant,
        device: &Device,
    ) -> Exchanged {
        self.silent_since = None;
        self.phase.note_answer();
        let timestamps = device.session.timestamps;
        if self.clock == ClockName::RealTime && timestamps.arrived > deadline {
            // The bench itself read the answer late; the motor had no torque in time all the same.
            return ControlFlow::Continue((StepOutcome::Unanswered, None));
        }
        self.torque.torque_nm = answer.torque_nm;
        // Of a retransmitted sample it is unknown which copy was answered.
        let has_times = self.is_timed && !request.is_retransmission;
        let round_trip = has_times.then(|| RoundTrip::new(&timestamps, answer));
        ControlFlow::Continue((StepOutcome::Answered, round_trip))
    }

    /// The end of the run after an answer that does not pass.
    fn reject(&mut self, device: &mut Device) -> Result<Exchanged, RunError> {
        let Some(broken) = self.answers.broken else { return Ok(self.give_up()) };
        if !matches!(broken.rule, AnswerRule::Running { .. }) {
            return Ok(ControlFlow::Break(End::RuleBroken(broken)));
        }
        self.timeline.pause();
        let fault = latched_fault(device).map_err(|source| device.explain(source))?;
        let end = fault.map_or(End::RuleBroken(broken), |fault| End::DriveFault(fault.into()));
        Ok(ControlFlow::Break(end))
    }

    fn give_up(&mut self) -> Exchanged {
        self.counts.unanswered += 1;
        ControlFlow::Continue((StepOutcome::Unanswered, None))
    }

    /// Handles the loss of the drive in an exchange.
    fn lose(&mut self, source: SessionError, device: &mut Device) -> Result<Exchanged, RunError> {
        Ok(match self.recover(source, device)? {
            Some(end) => ControlFlow::Break(end),
            None => self.give_up(),
        })
    }

    /// Gets a lost drive back if the scenario asks for that; else returns the end of the run.
    fn recover(&mut self, source: SessionError, device: &mut Device) -> Result<Option<End>, RunError> {
        if let Some(end) = reconnect::end_of_loss(source, self.scenario, device) {
            return end.map(Some);
        }
        // A drive without a host gives no torque, and it is set up, armed and started from there.
        self.torque.torque_nm = 0.0;
        self.timeline.pause();
        let stop_asked = || self.sink.stop_asked();
        let end = reconnect::set_up_again(self.scenario, self.clock, &mut self.timeline, device, stop_asked)?;
        match end {
            ControlFlow::Break(end) => Ok(Some(end)),
            ControlFlow::Continue(torque_limit_nm) => {
                self.answers = AnswerCheck::new(torque_limit_nm, may_duplicate_samples(self.scenario));
                self.phase = Phase::Restarting;
                self.silent_since = None;
                self.counts.resumes += 1;
                Ok(None)
            }
        }
    }

    fn start_again(&mut self, device: &mut Device) -> Result<Option<End>, RunError> {
        self.timeline.pause();
        match reconnect::start_again(self.clock, device) {
            Ok(true) => self.phase = Phase::Started,
            Ok(false) => {}
            Err(source) if source.is_loss() => return self.recover(source, device),
            Err(source) => return Err(setup::refused_start(device, source)),
        }
        Ok(None)
    }

    /// Moves the plant on by a period under the torque of the step.
    fn hold(
        &mut self,
        step: u32,
        sample: Option<EncoderSample>,
        observed: Observation,
        timing: StepTiming,
    ) -> Result<(), RunError> {
        let torque_nm = self.torque.advance(timing.outcome == StepOutcome::Answered);
        let Observation { mut row, plant } = observed;
        row.torque_nm = torque_nm.into();
        let drive = DriveValues::unknown(self.drive_signals);
        self.unfinished = Some(Step { row, sample, plant, drive, timing });
        self.counts.steps += 1;
        Ok(self.simulator.step(step, torque_nm)?)
    }
}

/// Whether a fault of the scenario duplicates frames to the drive, which then answers a sample twice.
fn may_duplicate_samples(scenario: &Scenario) -> bool {
    scenario.faults.iter().any(|fault| {
        matches!(
            fault.kind,
            FaultKind::Frame { fault: FrameFault::Duplicate { .. }, way: Way::ToDrive | Way::Both }
        )
    })
}
