//! What closes the loop of a run. Pacing, start, stop and record are common to both modes.

use std::time::{Duration, Instant};

use super::bench_loop::BenchLoop;
use super::control_loop::ControlLoop;
use super::error::RunError;
use super::loop_state::{LoopSettings, LoopState};
use super::outcome::End;
use super::simulator::Simulator;
use super::step_sink::{Event, Item, StepSink};
use crate::device::Device;
use crate::fault::timeline::Timeline;
use crate::scenario::Scenario;
use crate::timing::ClockName;
use lashloop_session::LogEntry;

/// The loop of a run.
pub(super) enum RunLoop<'a, S> {
    /// A sample of the simulated plant for a torque, in every period.
    Hil(Box<ControlLoop<'a, S>>),
    /// A reference in every period, and the reports of the drive's own steps.
    Bench(Box<BenchLoop<'a, S>>),
}

impl<'a, S: StepSink> RunLoop<'a, S> {
    /// The loop for a drive that is about to be started, with the simulator of HIL mode; `None` in bench mode.
    pub(super) fn new(
        scenario: &'a Scenario,
        simulator: Option<Simulator>,
        timeline: Timeline,
        settings: LoopSettings,
        sink: S,
    ) -> Self {
        let state = LoopState::new(scenario, timeline, settings, sink);
        match simulator {
            Some(simulator) => Self::Hil(Box::new(ControlLoop::new(simulator, state))),
            None => Self::Bench(Box::new(BenchLoop::new(state))),
        }
    }

    pub(super) fn state(&mut self) -> &mut LoopState<'a, S> {
        match self {
            Self::Hil(control) => &mut control.state,
            Self::Bench(bench) => &mut bench.state,
        }
    }

    /// Periods of the bench at most. In bench mode the drive's clock decides, so there are more than the run has steps.
    pub(super) fn periods(&self) -> u32 {
        match self {
            Self::Hil(control) => control.state.scenario.run.steps(),
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
        let state = self.state();
        while let Some(edge) = state.timeline.next_edge() {
            state.sink.take(Item::Event { step, event: Event::Fault(edge) })?;
        }
        while let Some(entry) = device.session.line.logs.next_new() {
            let step = step_of(state, &entry, step, device);
            state.sink.take(Item::Event { step, event: Event::Log(entry) })?;
        }
        Ok(())
    }

    /// Makes a period that the bench has overslept, without an exchange.
    pub(super) fn miss(&mut self, step: u32, device: &mut Device) -> Result<(), RunError> {
        match self {
            Self::Hil(control) => control.miss(step, device),
            Self::Bench(bench) => bench.state.begin(step, device),
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
}

/// The step in which the drive formed a text that has arrived by `present`. In lockstep time has no steps.
fn step_of<S>(state: &LoopState<'_, S>, entry: &LogEntry, present: u32, device: &mut Device) -> u32 {
    let (ClockName::RealTime, LogEntry::Received { formed_at: Some(formed_at), .. }) =
        (state.settings.clock, entry)
    else {
        return present;
    };
    let ago = device.session.line.now().saturating_duration_since(*formed_at);
    let periods = ago.as_micros() / u128::from(state.scenario.run.control_period_us);
    present.saturating_sub(u32::try_from(periods).unwrap_or(u32::MAX))
}
