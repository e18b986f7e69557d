//! Runs for the tests of this module.

use super::{Measured, Measurement, Metric, Metrics, Sample, SignalTable};
use crate::Signal;

pub(super) const PERIOD_S: f64 = 0.001;

/// The signals that today's plants and laws offer to the metrics.
pub(super) fn signals() -> SignalTable {
    SignalTable {
        plant: vec![Signal::new("dead_zone_rad", "rad"), Signal::new("disturbing_torque_nm", "N m")],
        drive: vec![
            Signal::new("dead_zone_estimate_rad", "rad"),
            Signal::new("disturbing_torque_estimate_nm", "N m"),
            Signal::new("dead_zone_deviation_rad", "rad"),
        ],
    }
}

/// A load on its reference of 0 rad, without torque and telemetry, on a plant with a half gap of 0.1 rad.
pub(super) fn at_rest(time_s: f64) -> Sample<'static> {
    Sample {
        time_s,
        reference_rad: 0.0,
        load_position_rad: 0.0,
        motor_position_rad: 0.0,
        torque_nm: 0.0,
        plant: &[0.1, 0.0],
        drive: None,
    }
}

/// Number of samples in `seconds`.
pub(super) fn steps(seconds: f64) -> u32 {
    (seconds / PERIOD_S).round() as u32
}

/// Measures `seconds` of samples that are a function of time.
pub(super) fn measure(
    mut measurement: Measurement,
    seconds: f64,
    at: impl Fn(f64) -> Sample<'static>,
) -> Metrics {
    for step in 0..steps(seconds) {
        measurement.push(&at(f64::from(step) * PERIOD_S));
    }
    measurement.metrics()
}

#[track_caller]
pub(super) fn assert_close(what: impl std::fmt::Display, have: Measured, want: f64) {
    let close = have.value().is_some_and(|have| (have - want).abs() < 1e-9);
    assert!(close, "{what}: have {have}, want {want}");
}

#[track_caller]
pub(super) fn assert_metric(metrics: &Metrics, metric: Metric, want: f64) {
    assert_close(metric, metrics.get(metric), want);
}
