//! What a run computes from its steps: metrics, digest and timing.

use lashloop_plant::metrics::{Measurement, Metrics, Plan, SignalTable};

use super::digest::TorqueDigest;
use super::error::RunError;
use super::step_sink::{Item, StepObserver, StepSink};
use crate::scenario::expectation::Expectation;
use crate::scenario::{RunMode, Scenario};
use crate::timing::{ClockName, Timings};

/// Measures, digests and times the steps of a run, and passes them on to its observer.
pub(super) struct StepRecorder<'a> {
    observer: &'a mut dyn StepObserver,
    pub(super) measurement: Measurement,
    pub(super) digest: TorqueDigest,
    pub(super) timings: Timings,
    mode: RunMode,
}

impl<'a> StepRecorder<'a> {
    /// `signals` are those that the run measures.
    pub(super) fn new(
        scenario: &Scenario,
        signals: &SignalTable,
        clock: ClockName,
        observer: &'a mut dyn StepObserver,
    ) -> Self {
        let run = &scenario.run;
        let plan = Plan {
            period_s: run.control_period_s(),
            steps: run.steps(),
            reference: Some(&scenario.reference),
            signals,
        };
        Self {
            observer,
            measurement: Measurement::of_run(&plan, scenario.expectations.iter().map(Expectation::query)),
            digest: TorqueDigest::default(),
            timings: Timings::new(clock, run.control_period_us, run.warm_up_steps.into()),
            mode: run.mode,
        }
    }

    /// The metrics of the steps so far.
    pub(super) fn metrics(&self) -> Metrics {
        let metrics = self.measurement.metrics();
        match self.mode {
            RunMode::Hil => metrics,
            RunMode::Bench => metrics.without_truth(),
        }
    }
}

impl StepSink for &mut StepRecorder<'_> {
    fn take(&mut self, item: Item) -> Result<(), RunError> {
        match item {
            Item::Step(step) => {
                self.digest.push(step.row.torque_nm as f32);
                self.timings.push(&step.timing);
                self.measurement.push(&step.measured(self.mode));
                self.observer.step(&step)?;
            }
            Item::Event { step, event } => self.observer.event(step, &event)?,
        }
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.observer.stop_asked()
    }
}
