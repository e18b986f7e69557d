//! What closes the loop of a run. Pacing, start, stop and record are common to both modes.

use std::time::{Duration, Instant};

use super::bench_loop::BenchLoop;
use super::control_loop::{ControlLoop, Counts, LoopSettings};
use super::error::RunError;
use super::outcome::End;
use super::simulator::Simulator;
use super::step_sink::{Event, StepSink};
use crate::device::Device;
use crate::fault::timeline::Timeline;
use crate::scenario::Scenario;
use crate::timing::ClockName;
use lashloop_session::LogEntry;

/// Where the steps of a run come from.
pub(super) enum StepSource {
    /// HIL mode: samples of this simulator.
    Simulator(Box<Simulator>),
    /// Bench mode: the drive's own encoders and tick.
    Pins,
}

/// The loop of a run.
pub(super) enum RunLoop<'a, S> {
    /// A sample of the simulated plant for a torque, in every period.
    Hil(Box<ControlLoop<'a, S>>),
    /// A reference in every period, and the reports of the drive's own steps.
    Bench(Box<BenchLoop<'a, S>>),
}

impl<'a, S: StepSink> RunLoop<'a, S> {
    /// The loop for a drive that is about to be started.
    pub(super) fn new(
        scenario: &'a Scenario,
        source: StepSource,
        timeline: Timeline,
        settings: LoopSettings,
        sink: S,
    ) -> Self {
        match source {
            StepSource::Simulator(simulator) => {
                Self::Hil(Box::new(ControlLoop::new(scenario, *simulator, timeline, settings, sink)))
            }
            StepSource::Pins => Self::Bench(Box::new(BenchLoop::new(scenario, timeline, settings, sink))),
        }
    }

    /// Periods of the bench at most. In bench mode the drive's clock decides, so there are more than the run has steps.
    pub(super) fn periods(&self) -> u32 {
        match self {
            Self::Hil(control) => control.scenario.run.steps(),
            Self::Bench(bench) => bench.periods(),
        }
    }

    /// Makes the exchange of a period, at the latest by `deadline`. `lateness` is from the due time of the period to its
    /// beginning.
    pub(super) fn step(
        &mut self,
        step: u32,
        deadline: Instant,
        lateness: Duration,
        device: &mut Device,
    ) -> Result<Option<End>, RunError> {
        let ended = match self {
            Self::Hil(control) => control.step(step, deadline, lateness, device),
            Self::Bench(bench) => bench.step(step, deadline, device),
        };
        let passed_on = self.pass_events_on(step, device);
        let end = ended?;
        passed_on?;
        Ok(end)
    }

    /// Passes on what has happened since the last call.
    pub(super) fn pass_events_on(&mut self, step: u32, device: &mut Device) -> Result<(), RunError> {
        while let Some(edge) = self.timeline().next_edge() {
            self.sink().take_event(step, Event::Fault(edge))?;
        }
        while let Some(entry) = device.session.line.logs.next_new() {
            let step = self.step_of(&entry, step, device);
            self.sink().take_event(step, Event::Log(entry))?;
        }
        Ok(())
    }

    /// The step in which the drive formed a text that has arrived by `present`. In lockstep time has no steps.
    fn step_of(&self, entry: &LogEntry, present: u32, device: &mut Device) -> u32 {
        let (clock, scenario) = match self {
            Self::Hil(control) => (control.clock, control.scenario),
            Self::Bench(bench) => (bench.settings.clock, bench.scenario),
        };
        let (ClockName::RealTime, LogEntry::Received { formed_at: Some(formed_at), .. }) = (clock, entry)
        else {
            return present;
        };
        let ago = device.session.line.now().saturating_duration_since(*formed_at);
        let periods = ago.as_micros() / u128::from(scenario.run.control_period_us);
        present.saturating_sub(u32::try_from(periods).unwrap_or(u32::MAX))
    }

    fn sink(&mut self) -> &mut S {
        match self {
            Self::Hil(control) => &mut control.sink,
            Self::Bench(bench) => &mut bench.sink,
        }
    }

    /// Makes a period that the bench has overslept, without an exchange.
    pub(super) fn miss(&mut self, step: u32, device: &mut Device) -> Result<(), RunError> {
        match self {
            Self::Hil(control) => control.miss(step, device),
            Self::Bench(bench) => bench.miss(step, device),
        }
    }

    /// Ends the run after its last period.
    pub(super) fn complete(&mut self, device: &Device) -> Result<End, RunError> {
        match self {
            Self::Hil(_) => {}
            Self::Bench(bench) => bench.complete(device)?,
        }
        Ok(End::Complete)
    }

    /// Passes the last step on, with the drive's latest signals.
    pub(super) fn finish(&mut self, device: &Device) -> Result<(), RunError> {
        match self {
            Self::Hil(control) => control.finish(device),
            Self::Bench(bench) => bench.finish(device),
        }
    }

    pub(super) fn stop_asked(&self) -> bool {
        match self {
            Self::Hil(control) => control.sink.stop_asked(),
            Self::Bench(bench) => bench.sink.stop_asked(),
        }
    }

    pub(super) fn counts(&self) -> Counts {
        match self {
            Self::Hil(control) => control.counts,
            Self::Bench(bench) => bench.counts(),
        }
    }

    pub(super) fn timeline(&mut self) -> &mut Timeline {
        match self {
            Self::Hil(control) => &mut control.timeline,
            Self::Bench(bench) => &mut bench.timeline,
        }
    }
}
