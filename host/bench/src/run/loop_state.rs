//! What the loops of both modes have in common.

use std::time::Duration;

use lashloop_protocol::message::EncoderSample;

use super::error::RunError;
use super::step::{DriveValues, Step, TraceRow, TruthValues};
use super::step_sink::{Item, StepSink};
use super::waiting_time::WaitingTime;
use crate::device::Device;
use crate::fault::timeline::Timeline;
use crate::scenario::Scenario;
use crate::timing::{ClockName, StepTiming};

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
    /// Recorded steps, missed ones included.
    pub(super) steps: u32,
    /// Samples without a torque by their deadline; in bench mode recorded steps without a report.
    pub(super) unanswered: u64,
    /// Times that the drive was lost and came back.
    pub(super) resumes: u64,
}

/// What the loops of both modes have in common.
pub(super) struct LoopState<'a, S> {
    pub(super) scenario: &'a Scenario,
    pub(super) sink: S,
    pub(super) timeline: Timeline,
    pub(super) settings: LoopSettings,
    pub(super) counts: Counts,
    /// `None` in real time, where the clock bounds every wait, and in a run without times, whose waits are virtual.
    waiting: Option<WaitingTime>,
    /// The last step. Its telemetry follows its torque or its report, so it is complete only with the next one.
    unfinished: Option<Step>,
}

impl<'a, S: StepSink> LoopState<'a, S> {
    /// The state for a drive that is about to be started.
    pub(super) fn new(scenario: &'a Scenario, timeline: Timeline, settings: LoopSettings, sink: S) -> Self {
        let waiting = || WaitingTime::new(scenario.link.mean_wait(), scenario.link.answer_timeout());
        let waiting = (settings.clock == ClockName::Lockstep && settings.is_timed).then(waiting);
        Self { scenario, sink, timeline, settings, counts: Counts::default(), waiting, unfinished: None }
    }

    /// Begins a step.
    pub(super) fn begin(&mut self, step: u32, device: &mut Device) -> Result<(), RunError> {
        Ok(self.timeline.begin(step, device).map_err(|source| device.explain(source))?)
    }

    /// Counts the wait for a sample.
    pub(super) fn spend(&mut self, wait: Duration, device: &Device) -> Result<(), RunError> {
        if let Some(waiting) = &mut self.waiting {
            let spent = waiting.spend(wait, || device.connection.host.busy());
            spent.map_err(|source| device.explain(source))?;
        }
        Ok(())
    }

    /// Keeps a step until it is finished.
    pub(super) fn record(
        &mut self,
        row: TraceRow,
        sample: Option<EncoderSample>,
        plant: TruthValues,
        timing: StepTiming,
    ) {
        let drive = DriveValues::unknown(self.settings.drive_signals);
        self.unfinished = Some(Step { row, sample, plant, drive, timing });
        self.counts.steps += 1;
    }

    /// Passes the last step on, with the drive's latest signals. `origin` is the step of the drive's first sample, if it was
    /// sent.
    pub(super) fn finish(&mut self, origin: Option<u32>, device: &Device) -> Result<(), RunError> {
        let Some(step) = &mut self.unfinished else { return Ok(()) };
        if let Some((telemetry, origin)) = device.session.line.telemetry.zip(origin) {
            step.drive.take(&telemetry, origin, self.scenario.run.control_period_s(), device)?;
        }
        self.unfinished.take().map_or(Ok(()), |step| self.sink.take(Item::Step(step)))
    }
}
