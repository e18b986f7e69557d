//! What is kept of every step: measured, digested, timed, and shown to whoever looks on. Never on the loop's thread in
//! real time.

use super::RunError;
use super::control_loop::Sink;
use crate::atomic_file::WriteError;
use crate::record::digest::TorqueDigest;
use crate::record::trace::TraceRow;
use crate::scenario::Scenario;
use crate::timing::{ClockName, StepTiming, Timings};
use lashloop_plant::metrics::{Estimates, Measurement, Sample};

/// Whoever looks on: a record, a progress bar, a plot.
pub trait Watcher {
    /// A step is complete.
    ///
    /// # Errors
    /// It could not be kept; the run ends.
    fn step(&mut self, step: &Step) -> Result<(), WriteError>;

    /// Whether the run is to end early. Asked once in a step.
    fn stop_asked(&self) -> bool {
        false
    }
}

/// A step as the loop hands it over.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// The truth and the torque.
    pub row: TraceRow,
    /// How it went in time.
    pub timing: StepTiming,
}

/// Gathers the steps of a run.
pub(super) struct StepRecorder<'a> {
    watcher: &'a mut dyn Watcher,
    pub(super) measurement: Measurement,
    pub(super) digest: TorqueDigest,
    pub(super) timings: Timings,
}

impl<'a> StepRecorder<'a> {
    pub(super) fn new(scenario: &Scenario, clock: ClockName, watcher: &'a mut dyn Watcher) -> Self {
        let run = &scenario.run;
        Self {
            watcher,
            measurement: Measurement::new(run.control_period_s())
                .with_middle_of_reference(scenario.reference.middle_rad()),
            digest: TorqueDigest::default(),
            timings: Timings::new(clock, run.control_period_us, run.warm_up_steps.into()),
        }
    }
}

impl Sink for &mut StepRecorder<'_> {
    fn take(&mut self, step: Step) -> Result<(), RunError> {
        let Step { row, timing } = &step;
        self.digest.push(row.torque_nm as f32);
        self.timings.push(timing);
        self.measurement.push(&Sample {
            time_s: row.time_s,
            reference_rad: row.reference_rad,
            load_position_rad: row.load_position_rad,
            torque_nm: row.torque_nm,
            estimates: estimates(row),
            dead_zone_rad: row.dead_zone_rad,
            disturbing_torque_nm: row.disturbing_torque_nm,
        });
        Ok(self.watcher.step(&step)?)
    }

    fn stop_asked(&self) -> bool {
        self.watcher.stop_asked()
    }
}

/// The drive's estimates of this very step: what is only shown again until the next telemetry, or came too late, is not
/// compared with another step's truth.
fn estimates(row: &TraceRow) -> Option<Estimates> {
    (row.estimate_time_s == row.time_s).then_some(Estimates {
        dead_zone_rad: row.dead_zone_estimate_rad,
        disturbing_torque_nm: row.disturbing_torque_estimate_nm,
    })
}
