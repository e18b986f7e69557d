//! Bench mode: the drive makes the steps by its own tick; the bench sends references and takes the reports.
//!
//! Nothing is simulated, so there is no truth: positions are those of the drive's encoders, and the signals of the plant are
//! NaN. A report that is lost on the line leaves a step without a measurement; the record repeats the last one, and the step
//! counts as unanswered. Nothing here allocates, locks or logs.

use std::time::{Duration, Instant};

use lashloop_plant::limits::MAX_SIGNALS;
use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::State;
use lashloop_protocol::message::{BenchSample, EncoderSample};
use lashloop_protocol::sequence::nearest_step;

use super::answer_check::broken_torque_rule;
use super::bench_phase::{BenchPhase, Measurement};
use super::bench_positions::BenchPositions;
use super::error::RunError;
use super::latched_fault::latched_fault;
use super::loop_state::{LoopSettings, LoopState};
use super::outcome::End;
use super::reconnect;
use super::step::{TraceRow, TruthValues};
use super::step_sink::StepSink;
use crate::device::{Device, DeviceError};
use crate::scenario::bench::BenchStart;
use crate::timing::{ClockName, StepOutcome, StepTiming};
use crate::verdict::{AnswerRule, BrokenRule};
use lashloop_session::{AtStep, BenchReport, SessionError};

/// Largest distance of the load from its start at the first step, in rad. An initial condition is part of the scenario.
const START_TOLERANCE_RAD: f64 = 0.02;
/// Periods after the run for a drive whose clock is slow: the internal oscillator of a chip is 8 % slow at worst.
const SLOWEST_CLOCK: u32 = 10;
/// Further periods, for the first tick and the last report.
const MARGIN_PERIODS: u32 = 20;
/// Time for the report of a fault after the step that caused it.
const FAULT_REPORT_LIMIT: Duration = Duration::from_millis(100);

/// The loop of a run in bench mode.
pub(super) struct BenchLoop<'a, S> {
    pub(super) state: LoopState<'a, S>,
    phase: BenchPhase,
    positions: BenchPositions,
}

impl<'a, S: StepSink> BenchLoop<'a, S> {
    /// The loop for a drive that is about to be started.
    pub(super) fn new(state: LoopState<'a, S>) -> Self {
        let positions = BenchPositions::new(state.scenario);
        Self { state, phase: BenchPhase::Started, positions }
    }

    /// The next step to be recorded.
    fn next_step(&self) -> u32 {
        self.state.counts.steps
    }

    /// Periods of the bench at most.
    pub(super) fn periods(&self) -> u32 {
        let steps = self.state.scenario.run.steps();
        match self.state.settings.clock {
            ClockName::Lockstep => steps,
            ClockName::RealTime => steps.saturating_add(steps / SLOWEST_CLOCK + MARGIN_PERIODS),
        }
    }

    /// Sends the reference of a period, and takes the reports that arrive by `deadline`; neither in a period without a report.
    pub(super) fn step(
        &mut self,
        period: u32,
        deadline: Instant,
        device: &mut Device,
    ) -> Result<Option<End>, RunError> {
        self.state.begin(period, device)?;
        if !period.is_multiple_of(self.state.scenario.bench.sample_every) {
            return Ok(None);
        }
        let reference_rad = self.reference_rad(period) - self.reference_zero_rad();
        let asked = Instant::now();
        let reports = device
            .session
            .send_reference(period, reference_rad as f32)
            .and_then(|()| self.report(deadline, device));
        let mut report = match reports {
            Ok(report) => report,
            Err(source) => return self.lose(source, device),
        };
        self.state.spend(asked.elapsed(), device)?;
        while let Some((present, arrived)) = report {
            if let Some(end) = self.take(present, arrived, period, device)? {
                return Ok(Some(end));
            }
            let is_last = self.state.settings.clock == ClockName::Lockstep && self.next_step() > period;
            // Reports of a drive with a faster clock have gathered.
            let now = device.session.line.now();
            report = match if is_last { Ok(None) } else { self.report(now, device) } {
                Ok(report) => report,
                Err(source) => return self.lose(source, device),
            };
        }
        if self.next_step() >= self.state.scenario.run.steps() {
            return Ok(Some(End::Complete));
        }
        self.check_silence(device)
    }

    /// Completes the record of a drive that has reported fewer steps than the run has.
    pub(super) fn complete(&mut self, device: &Device) -> Result<(), RunError> {
        self.fill_steps_before(self.state.scenario.run.steps(), device)
    }

    /// Passes the last step on, with the drive's latest signals.
    pub(super) fn finish(&mut self, device: &Device) -> Result<(), RunError> {
        self.state.finish(Some(0), device)
    }

    /// The next report, with the time of its arrival.
    fn report(
        &mut self,
        deadline: Instant,
        device: &mut Device,
    ) -> Result<Option<(BenchReport, Instant)>, SessionError> {
        self.phase.note_sent(device.session.line.now());
        let Some(report) = device.session.bench_report(deadline)? else { return Ok(None) };
        let arrived = device.session.line.now();
        self.phase.note_report(arrived);
        Ok(Some((report, arrived)))
    }

    fn take(
        &mut self,
        report: BenchReport,
        arrived: Instant,
        period: u32,
        device: &mut Device,
    ) -> Result<Option<End>, RunError> {
        let sample = match report {
            BenchReport::Faulted(fault) => return Ok(Some(End::DriveFault(fault.into()))),
            BenchReport::Refused(state) => return self.find_fault(state, None, period, device).map(Some),
            BenchReport::Step(sample) => sample,
        };
        // A line may duplicate frames.
        if sample.step < self.next_step() || sample.step >= self.state.scenario.run.steps() {
            return Ok(None);
        }
        let BenchSample { sequence, torque_nm, status, reference_number, .. } = sample.message;
        let broken = |rule| Ok(Some(End::RuleBroken(BrokenRule { rule, step: sample.step, sequence })));
        if let Some(rule) = broken_torque_rule(torque_nm, status, self.state.settings.torque_limit_nm) {
            return broken(rule);
        }
        if status.state != State::Running {
            return self.find_fault(status.state, Some(sequence), sample.step, device).map(Some);
        }
        let Some(reference) = nearest_step(reference_number, period).filter(|it| *it <= period) else {
            return broken(AnswerRule::ReferenceSent { number: reference_number });
        };
        self.fill_steps_before(sample.step, device)?;
        self.measure(&sample, reference, arrived, device)?;
        let end = self.leave_travel();
        let steps = self.state.scenario.run.steps();
        if end.is_none() && steps - sample.step <= self.state.scenario.bench.sample_every {
            self.fill_steps_before(steps, device)?;
        }
        Ok(end)
    }

    /// The end of a run whose load has left its travel.
    fn leave_travel(&self) -> Option<End> {
        let BenchPhase::Measuring { travel_zero_rad, latest, .. } = &self.phase else { return None };
        let limit_rad = self.state.scenario.bench.load_travel_limit_rad?;
        let reached_rad = (latest.row.load_position_rad - travel_zero_rad).abs();
        (reached_rad > limit_rad).then_some(End::BeyondTravel { reached_rad, limit_rad })
    }

    /// Records a step that the drive has reported.
    fn measure(
        &mut self,
        sample: &AtStep<BenchSample>,
        reference: u32,
        arrived: Instant,
        device: &Device,
    ) -> Result<(), RunError> {
        let (motor_position_rad, load_position_rad) = self.positions.take(sample);
        let travel_zero_rad = match self.phase {
            BenchPhase::Measuring { travel_zero_rad, .. } => travel_zero_rad,
            BenchPhase::Started | BenchPhase::AwaitingFirstStep { .. } => {
                self.travel_zero_rad(load_position_rad, device)?
            }
        };
        let row = TraceRow {
            time_s: 0.0,
            reference_rad: self.reference_rad(reference),
            load_position_rad,
            motor_position_rad,
            torque_nm: sample.torque_nm.into(),
        };
        let tenths_us = |count: u16| Duration::from_nanos(100 * u64::from(count));
        let timing = StepTiming {
            lateness: tenths_us(sample.lateness_tenths_us),
            tick_compute: Some(tenths_us(sample.compute_tenths_us)),
            ..StepTiming::of(StepOutcome::Answered)
        };
        let latest = Measurement { step: sample.step, row, timing };
        self.phase = BenchPhase::Measuring { silent_since: arrived, travel_zero_rad, latest };
        let reported = EncoderSample {
            sequence: sample.sequence,
            motor_counts: sample.motor_counts,
            load_counts: sample.load_counts,
            reference_rad: (row.reference_rad - self.positions.load_zero_rad()) as f32,
        };
        self.record(Some(reported), timing, device)
    }

    /// Zero of the travel of a load that the drive first reports at this position.
    ///
    /// # Errors
    /// The load is not where the scenario starts.
    fn travel_zero_rad(&self, load_position_rad: f64, device: &Device) -> Result<f64, RunError> {
        match self.state.scenario.bench.start {
            BenchStart::Anywhere => Ok(load_position_rad),
            BenchStart::Initial => {
                let distance_rad = load_position_rad - self.positions.load_zero_rad();
                if distance_rad.abs() > START_TOLERANCE_RAD {
                    let device = device.connection.choice.to_string();
                    let tolerance_rad = START_TOLERANCE_RAD;
                    return Err(DeviceError::AwayFromStart { device, distance_rad, tolerance_rad }.into());
                }
                Ok(0.0)
            }
        }
    }

    /// Records the steps before `step` with the last measurement: those without a report after one that has arrived, and those
    /// whose report is lost.
    fn fill_steps_before(&mut self, step: u32, device: &Device) -> Result<(), RunError> {
        while self.next_step() < step {
            let timing = self.phase.timing_of(self.next_step(), self.state.scenario.bench.sample_every);
            if timing.outcome == StepOutcome::Unanswered {
                self.state.counts.unanswered += 1;
            }
            self.record(None, timing, device)?;
        }
        Ok(())
    }

    fn record(
        &mut self,
        sample: Option<EncoderSample>,
        timing: StepTiming,
        device: &Device,
    ) -> Result<(), RunError> {
        self.finish(device)?;
        let LoopSettings { plant_signals, .. } = self.state.settings;
        let time_s = f64::from(self.next_step()) * self.state.scenario.run.control_period_s();
        let row = TraceRow { time_s, ..self.latest_row() };
        let plant: TruthValues = std::iter::repeat_n(f64::NAN, plant_signals.min(MAX_SIGNALS)).collect();
        self.state.record(row, sample, plant, timing);
        Ok(())
    }

    /// The last measurement; before the first one, the start of the scenario.
    fn latest_row(&self) -> TraceRow {
        match &self.phase {
            BenchPhase::Measuring { latest, .. } => latest.row,
            BenchPhase::Started | BenchPhase::AwaitingFirstStep { .. } => {
                let start = &self.state.scenario.plant.initial;
                TraceRow {
                    time_s: 0.0,
                    reference_rad: self.reference_rad(0),
                    load_position_rad: start.load_position_rad,
                    motor_position_rad: start.motor_position_rad,
                    torque_nm: 0.0,
                }
            }
        }
    }

    /// The end of the run with a drive that runs no more: the fault that it has latched, or the rule that it breaks.
    fn find_fault(
        &mut self,
        state: State,
        sequence: Option<u16>,
        step: u32,
        device: &mut Device,
    ) -> Result<End, RunError> {
        self.state.timeline.pause();
        let deadline = device.session.line.now() + FAULT_REPORT_LIMIT;
        let line = &mut device.session.line;
        let fault = match line.fault {
            None => line.wait(deadline, |message| match message {
                DriveMessage::FaultReport(_) => Some(()),
                _ => None,
            }),
            Some(_) => Ok(None),
        };
        let fault = fault.and_then(|_| latched_fault(device)).map_err(|source| device.explain(source))?;
        let rule = AnswerRule::Running { state };
        let broken = BrokenRule { rule, step, sequence: sequence.unwrap_or_default() };
        Ok(fault.map_or(End::RuleBroken(broken), |fault| End::DriveFault(fault.into())))
    }

    fn check_silence(&mut self, device: &mut Device) -> Result<Option<End>, RunError> {
        let limit = self.state.scenario.link.silence_limit();
        let Some(silent_since) = self.phase.silent_since() else { return Ok(None) };
        if device.session.line.now().saturating_duration_since(silent_since) < limit {
            return Ok(None);
        }
        let silent = device.session.line.silent("Reference", limit);
        self.lose(silent, device)
    }

    fn lose(&mut self, source: SessionError, device: &Device) -> Result<Option<End>, RunError> {
        if !source.is_loss() {
            return Err(device.explain(source).into());
        }
        match reconnect::end_of_loss(source, self.state.scenario, device) {
            Some(end) => end.map(Some),
            // The reader of scenarios rejects it.
            None => Ok(Some(End::DriveRestarted)),
        }
    }

    /// What a reference is relative to: a drive counts from its power-up on, and a torque is relative to nothing.
    fn reference_zero_rad(&self) -> f64 {
        if self.state.settings.takes_torque { 0.0 } else { self.positions.load_zero_rad() }
    }

    fn reference_rad(&self, period: u32) -> f64 {
        self.state
            .scenario
            .reference
            .position_rad(f64::from(period) * self.state.scenario.run.control_period_s())
    }
}
