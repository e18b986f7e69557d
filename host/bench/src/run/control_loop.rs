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
use super::loop_state::{LoopSettings, LoopState};
use super::outcome::End;
use super::phase::{Phase, Request};
use super::simulator::Simulator;
use super::step::Observation;
use super::step_sink::StepSink;
use super::{reconnect, setup};
use crate::device::Device;
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, FrameFault, Way};
use crate::timing::{ClockName, RoundTrip, StepOutcome, StepTiming};
use crate::verdict::AnswerRule;
use lashloop_session::{Exchange, SessionError};

/// The loop of one run.
pub(super) struct ControlLoop<'a, S> {
    pub(super) state: LoopState<'a, S>,
    simulator: Simulator,
    phase: Phase,
    answers: AnswerCheck,
    torque: HeldTorque,
    /// When the first sample was sent that has no answer yet, in the link's time.
    silent_since: Option<Instant>,
}

/// How a step continues after its exchange.
type Exchanged = ControlFlow<End, (StepOutcome, Option<RoundTrip>)>;

impl<'a, S: StepSink> ControlLoop<'a, S> {
    /// The loop for a drive that is about to be started.
    pub(super) fn new(simulator: Simulator, state: LoopState<'a, S>) -> Self {
        let LoopSettings { watchdog, torque_limit_nm, .. } = state.settings;
        let period = Duration::from_micros(state.scenario.run.control_period_us.into());
        Self {
            answers: AnswerCheck::new(torque_limit_nm, may_duplicate_samples(state.scenario)),
            state,
            simulator,
            phase: Phase::Started,
            torque: HeldTorque::new(period, watchdog),
            silent_since: None,
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
        self.state.begin(step, device)?;
        let (sample, observation) = self.simulator.observe(step)?;
        let request = self.phase.request(step, sample, &self.simulator)?;
        let sent = request.as_ref().map(|it| it.sample);
        let exchanged = match request {
            Some(request) => self.exchange(step, &request, deadline, device)?,
            // The drive was lost again or started too late: the next step retries the start.
            None => self.give_up(),
        };
        let (outcome, round_trip, end) = match exchanged {
            ControlFlow::Continue((outcome, round_trip)) => (outcome, round_trip, None),
            ControlFlow::Break(end @ End::RuleBroken(_)) => {
                // The motor gets no torque of such a drive any more, and the record shows it.
                self.torque.torque_nm = 0.0;
                (StepOutcome::Answered, None, Some(end))
            }
            ControlFlow::Break(end) => return Ok(Some(end)),
        };
        self.finish(device)?;
        let timing = StepTiming { lateness, round_trip, ..StepTiming::of(outcome) };
        self.hold(step, sent, observation, timing)?;
        Ok(end)
    }

    /// Makes a step without an exchange: holds the last torque.
    pub(super) fn miss(&mut self, step: u32, device: &mut Device) -> Result<(), RunError> {
        self.state.begin(step, device)?;
        let (_, observation) = self.simulator.observe(step)?;
        self.finish(device)?;
        self.hold(step, None, observation, StepTiming::of(StepOutcome::Missed))
    }

    /// Passes the last step on, with the drive's latest signals.
    pub(super) fn finish(&mut self, device: &Device) -> Result<(), RunError> {
        self.state.finish(self.phase.origin(), device)
    }

    fn exchange(
        &mut self,
        step: u32,
        request: &Request,
        deadline: Instant,
        device: &mut Device,
    ) -> Result<Exchanged, RunError> {
        let sent = device.session.line.now();
        let limit = self.state.scenario.link.silence_limit();
        let silent_at = self.silent_since.unwrap_or(sent) + limit;
        let Request { number, sample, .. } = request;
        self.answers.note_sent(*number, step);
        let passes = |answer: &TorqueAnswer| self.answers.passes(answer);
        let exchanged = device.session.exchange_checked(*number, sample, deadline.min(silent_at), passes);
        // Of wall-clock time, for a drive in this process waits in virtual time.
        if let Ok(Exchange::Answered(_) | Exchange::Unanswered) = exchanged {
            let times = device.session.timestamps;
            self.state.spend(times.decoded.saturating_duration_since(times.asked), device)?;
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
        if self.state.settings.clock == ClockName::RealTime && timestamps.arrived > deadline {
            // The bench itself read the answer late; the motor had no torque in time all the same.
            return ControlFlow::Continue((StepOutcome::Unanswered, None));
        }
        self.torque.torque_nm = answer.torque_nm;
        // Of a retransmitted sample it is unknown which copy was answered.
        let has_times = self.state.settings.is_timed && !request.is_retransmission;
        let round_trip = has_times.then(|| RoundTrip::new(&timestamps, answer));
        ControlFlow::Continue((StepOutcome::Answered, round_trip))
    }

    /// The end of the run after an answer that does not pass.
    fn reject(&mut self, device: &mut Device) -> Result<Exchanged, RunError> {
        let Some(broken) = self.answers.broken else { return Ok(self.give_up()) };
        if !matches!(broken.rule, AnswerRule::Running { .. }) {
            return Ok(ControlFlow::Break(End::RuleBroken(broken)));
        }
        self.state.timeline.pause();
        let fault = latched_fault(device).map_err(|source| device.explain(source))?;
        let end = fault.map_or(End::RuleBroken(broken), |fault| End::DriveFault(fault.into()));
        Ok(ControlFlow::Break(end))
    }

    fn give_up(&mut self) -> Exchanged {
        self.state.counts.unanswered += 1;
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
        if let Some(end) = reconnect::end_of_loss(source, self.state.scenario, device) {
            return end.map(Some);
        }
        // A drive without a host gives no torque, and it is set up, armed and started from there.
        self.torque.torque_nm = 0.0;
        self.state.timeline.pause();
        let stop_asked = || self.state.sink.stop_asked();
        let end = reconnect::set_up_again(
            self.state.scenario,
            self.state.settings.clock,
            &mut self.state.timeline,
            device,
            stop_asked,
        )?;
        match end {
            ControlFlow::Break(end) => Ok(Some(end)),
            ControlFlow::Continue(torque_limit_nm) => {
                self.answers = AnswerCheck::new(torque_limit_nm, may_duplicate_samples(self.state.scenario));
                self.phase = Phase::Restarting;
                self.silent_since = None;
                self.state.counts.resumes += 1;
                Ok(None)
            }
        }
    }

    fn start_again(&mut self, device: &mut Device) -> Result<Option<End>, RunError> {
        self.state.timeline.pause();
        match reconnect::start_again(self.state.settings.clock, device) {
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
        self.state.record(row, sample, plant, timing);
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
