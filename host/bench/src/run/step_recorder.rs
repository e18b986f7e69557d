//! What a run computes from its steps: metrics, digest and timing.

use lashloop_plant::metrics::{Estimates, Measurement, Sample};

use super::error::RunError;
use super::step_sink::{Step, StepObserver, StepSink};
use crate::record::digest::TorqueDigest;
use crate::record::trace::TraceRow;
use crate::scenario::Scenario;
use crate::timing::{ClockName, Timings};

/// Measures, digests and times the steps of a run, and passes them on to its observer.
pub(super) struct StepRecorder<'a> {
    observer: &'a mut dyn StepObserver,
    pub(super) measurement: Measurement,
    pub(super) digest: TorqueDigest,
    pub(super) timings: Timings,
}

impl<'a> StepRecorder<'a> {
    pub(super) fn new(scenario: &Scenario, clock: ClockName, observer: &'a mut dyn StepObserver) -> Self {
        let run = &scenario.run;
        Self {
            observer,
            measurement: Measurement::new(run.control_period_s())
                .with_middle_of_reference(scenario.reference.middle_rad()),
            digest: TorqueDigest::default(),
            timings: Timings::new(clock, run.control_period_us, run.warm_up_steps.into()),
        }
    }
}

impl StepSink for &mut StepRecorder<'_> {
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
        Ok(self.observer.step(&step)?)
    }

    fn stop_asked(&self) -> bool {
        self.observer.stop_asked()
    }
}

/// The drive's estimates for this very step. Estimates that are repeated until the next telemetry or came too late are not
/// compared with the truth of another step.
fn estimates(row: &TraceRow) -> Option<Estimates> {
    (row.estimate_time_s == row.time_s).then_some(Estimates {
        dead_zone_rad: row.dead_zone_estimate_rad,
        disturbing_torque_nm: row.disturbing_torque_estimate_nm,
    })
}
