//! Estimates with scores in closed form.

use crate::metrics::fixture::{PERIOD_S, assert_metric as assert_close, at_rest, signals, steps};
use crate::metrics::{Measured, Measurement, Metric, Metrics, Sample, SignalTable};

const ESTIMATOR_SCORES: [Metric; 5] = [
    Metric::DeadZoneSettleTime,
    Metric::DeadZoneBias,
    Metric::DeadZoneLargestError,
    Metric::DisturbingTorqueRmsError,
    Metric::DisturbingTorqueBias,
];

/// A run of `seconds` with j0 = 0.1 + 0.01 t and w = t, whose telemetry carries estimates with these errors every tenth
/// step.
fn with_telemetry_every_tenth(seconds: f64, errors: impl Fn(f64) -> Option<(f64, f64)>) -> Metrics {
    let mut measurement = Measurement::new(PERIOD_S, &signals());
    for step in 0..steps(seconds) {
        let time_s = f64::from(step) * PERIOD_S;
        let (dead_zone_rad, disturbing_torque_nm) = (0.1 + 0.01 * time_s, time_s);
        let errors = if step % 10 == 0 { errors(time_s) } else { None };
        let estimates =
            errors.map(|(error_rad, error_nm)| [dead_zone_rad + error_rad, disturbing_torque_nm + error_nm]);
        measurement.push(&Sample {
            load_position_rad: 1.0,
            plant: &[dead_zone_rad, disturbing_torque_nm],
            drive: estimates.as_ref().map(<[f64; 2]>::as_slice),
            ..at_rest(time_s)
        });
    }
    measurement.metrics()
}

fn dead_zone_errors(seconds: f64, error_rad: impl Fn(f64) -> f64) -> Metrics {
    with_telemetry_every_tenth(seconds, |t_s| Some((error_rad(t_s), 0.0)))
}

#[test]
fn estimate_is_compared_with_the_truth_of_its_own_sample() {
    // Held for nine more steps, the estimate would lag the rising truth by 4.5 ms on average.
    let metrics = with_telemetry_every_tenth(10.0, |_| Some((0.01, -0.5)));
    assert_close(&metrics, Metric::DisturbingTorqueBias, -0.5);
    assert_close(&metrics, Metric::DisturbingTorqueRmsError, 0.5);
    assert_close(&metrics, Metric::DeadZoneBias, 0.01);
    assert_close(&metrics, Metric::DeadZoneError, 0.01);
}

#[test]
fn alternating_errors_have_a_root_mean_square_and_no_bias() {
    let metrics = with_telemetry_every_tenth(10.0, |t_s| {
        Some((0.0, if (t_s * 100.0).round() % 2.0 == 0.0 { 0.3 } else { -0.3 }))
    });
    assert_close(&metrics, Metric::DisturbingTorqueRmsError, 0.3);
    assert_close(&metrics, Metric::DisturbingTorqueBias, 0.0);
}

#[test]
fn estimate_settles_when_it_enters_the_band_for_good() {
    // 0.5 exp(-t) is 0.02 at 3.2189 s; the next telemetry is at 3.22 s.
    assert_close(&dead_zone_errors(10.0, |t_s| 0.5 * (-t_s).exp()), Metric::DeadZoneSettleTime, 3.22);
    let late = dead_zone_errors(10.0, |t_s| if (t_s - 7.0).abs() < 1e-9 { 0.03 } else { 0.0 });
    assert_close(&late, Metric::DeadZoneSettleTime, 7.01);
}

#[test]
fn bias_is_the_signed_mean_of_the_last_five_seconds() {
    // The mean of -t over the estimates from 5.00 to 9.99 s.
    assert_close(&dead_zone_errors(10.0, |t_s| -t_s), Metric::DeadZoneBias, -7.495);
    let short = dead_zone_errors(4.999, |_| 0.0);
    assert_eq!(short.get(Metric::DeadZoneBias), Measured::RunTooShort);
}

#[test]
fn largest_error_counts_from_the_first_estimate_in_the_band() {
    let strays = |t_s: f64| {
        if t_s < 1.0 {
            9.0
        } else if (3.0..4.0).contains(&t_s) {
            -1.5
        } else {
            0.01
        }
    };
    let metrics = dead_zone_errors(10.0, strays);
    assert_close(&metrics, Metric::DeadZoneLargestError, 1.5);
    assert_close(&metrics, Metric::DeadZoneSettleTime, 4.0);
}

#[test]
fn estimate_outside_the_band_never_settles() {
    let metrics = dead_zone_errors(10.0, |_| 0.021);
    assert_eq!(metrics.get(Metric::DeadZoneSettleTime), Measured::Never);
    assert_eq!(metrics.get(Metric::DeadZoneLargestError), Measured::Never);
    assert_close(&metrics, Metric::DeadZoneBias, 0.021);
}

#[test]
fn drive_without_telemetry_is_not_scored() {
    let metrics = with_telemetry_every_tenth(10.0, |_| None);
    for metric in ESTIMATOR_SCORES.into_iter().chain([Metric::DeadZoneEstimate, Metric::DeadZoneError]) {
        assert_eq!(metrics.get(metric), Measured::NoTelemetry, "{metric}");
    }
    assert!(metrics.run_was_finite());
}

#[test]
fn drive_without_late_telemetry_has_no_bias_at_the_end() {
    let metrics = with_telemetry_every_tenth(10.0, |t_s| (t_s < 4.9).then_some((0.01, 0.5)));
    assert_eq!(metrics.get(Metric::DeadZoneBias), Measured::NoTelemetry);
    assert_close(&metrics, Metric::DisturbingTorqueBias, 0.5);
}

#[test]
fn estimate_that_is_not_finite_takes_its_own_scores_only() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let once = |t_s: f64| (t_s - 2.0).abs() < 1e-9;
        let dead_zone =
            with_telemetry_every_tenth(10.0, |t_s| Some((if once(t_s) { bad } else { 0.0 }, 0.5)));
        for metric in &ESTIMATOR_SCORES[..3] {
            assert_eq!(dead_zone.get(*metric), Measured::NotFinite, "{metric} with {bad}");
        }
        assert_close(&dead_zone, Metric::DisturbingTorqueRmsError, 0.5);
        let torque = with_telemetry_every_tenth(10.0, |t_s| Some((0.01, if once(t_s) { bad } else { 0.0 })));
        for metric in &ESTIMATOR_SCORES[3..] {
            assert_eq!(torque.get(*metric), Measured::NotFinite, "{metric} with {bad}");
        }
        assert_close(&torque, Metric::DeadZoneBias, 0.01);
        assert!(dead_zone.run_was_finite() && torque.run_was_finite());
    }
}

#[test]
fn metric_without_its_signal_names_it() {
    let of = |signals: &SignalTable, metric| Measurement::new(PERIOD_S, signals).metrics().get(metric);
    let no_gap = SignalTable { plant: Vec::new(), ..signals() };
    let no_estimate = SignalTable { drive: Vec::new(), ..signals() };
    for metric in ESTIMATOR_SCORES.into_iter().chain([Metric::DeadZoneEstimate, Metric::DeadZoneError]) {
        let torque = metric.name().starts_with("disturbing");
        let truth = if torque { "disturbing_torque_nm" } else { "dead_zone_rad" };
        let estimate =
            if torque { "drive.disturbing_torque_estimate_nm" } else { "drive.dead_zone_estimate_rad" };
        assert_eq!(of(&no_gap, metric), Measured::MissingSignal(truth), "{metric}");
        assert_eq!(of(&no_estimate, metric), Measured::MissingSignal(estimate), "{metric}");
    }
    let reason = of(&no_gap, Metric::DeadZoneBias).reason();
    assert_eq!(reason.as_deref(), Some("no signal dead_zone_rad"));
}

#[test]
fn signals_are_found_by_name_in_any_order() {
    let mut reversed = signals();
    reversed.plant.reverse();
    reversed.drive.reverse();
    let mut measurement = Measurement::new(PERIOD_S, &reversed);
    // w = 5 N m and j0 = 0.1 rad, estimated as 4 N m and 0.16 rad with a deviation of 0.02 rad.
    measurement.push(&Sample { plant: &[5.0, 0.1], drive: Some(&[0.02, 4.0, 0.16]), ..at_rest(0.0) });
    assert_close(&measurement.metrics(), Metric::DeadZoneError, 0.06);
    assert_close(&measurement.metrics(), Metric::DeadZoneDeviation, 0.02);
    assert_close(&measurement.metrics(), Metric::DisturbingTorqueBias, -1.0);
}

#[test]
fn estimates_beyond_their_own_deviations_are_counted() {
    let mut measurement = Measurement::new(PERIOD_S, &signals());
    // Errors of 0.5, 1.5, to 9.5 deviations; every other sample has no telemetry.
    for step in 0..20 {
        let deviation_rad = 0.02;
        let drive = [0.1 + (f64::from(step / 2) + 0.5) * deviation_rad, 0.0, deviation_rad];
        let telemetry = (step % 2 == 0).then_some(drive.as_slice());
        measurement.push(&Sample { drive: telemetry, ..at_rest(f64::from(step) * PERIOD_S) });
    }
    let metrics = measurement.metrics();
    assert_close(&metrics, Metric::DeadZoneBeyondTwo, 0.8);
    assert_close(&metrics, Metric::DeadZoneBeyondFour, 0.6);
}

#[test]
fn a_law_without_a_deviation_has_no_fraction_beyond_it() {
    let mut signals = signals();
    signals.drive.retain(|signal| signal.name != "dead_zone_deviation_rad");
    let mut measurement = Measurement::new(PERIOD_S, &signals);
    measurement.push(&Sample { drive: Some(&[0.1, 0.0]), ..at_rest(0.0) });
    let have = measurement.metrics().get(Metric::DeadZoneBeyondTwo);
    assert_eq!(have, Measured::MissingSignal("drive.dead_zone_deviation_rad"));
}
