//! Runs with metrics in closed form.

use crate::metrics::fixture::{self, PERIOD_S, assert_metric as assert_close, at_rest, signals};
use crate::metrics::{Measured, Measurement, Metric, Metrics, Plan, Sample};
use crate::reference::Reference;

/// A run of `seconds` whose error and torque are functions of time.
fn run(seconds: f64, error_rad: impl Fn(f64) -> f64, torque_nm: impl Fn(f64) -> f64) -> Metrics {
    let at = |time_s| Sample {
        reference_rad: 0.5,
        load_position_rad: 0.5 + error_rad(time_s),
        torque_nm: torque_nm(time_s),
        drive: Some(&[0.16, 0.0]),
        ..at_rest(time_s)
    };
    fixture::measure(Measurement::new(PERIOD_S, &signals()), seconds, at)
}

fn error(seconds: f64, error_rad: impl Fn(f64) -> f64) -> Metrics {
    run(seconds, error_rad, |_| 0.0)
}

#[test]
fn exponential_settles_when_it_enters_each_band() {
    // exp(-t) is 0.05 at 2.9957 s and 0.02 at 3.9120 s; the grid times after are 2.996 and 3.913.
    let metrics = error(10.0, |t_s| (-t_s).exp());
    assert_close(&metrics, Metric::SettleTime, 2.996);
    assert_close(&metrics, Metric::SettleTime5Pct, 2.996);
    assert_close(&metrics, Metric::SettleTime2Pct, 3.913);
    // And 0.01 at 4.6052 s.
    assert_close(&metrics, Metric::SettleTime1Pct, 4.606);
}

#[test]
fn leaving_the_band_again_restarts_settling() {
    let metrics = error(10.0, |t_s| if t_s < 1.0 || (t_s - 7.0).abs() < 1e-9 { 1.0 } else { 0.0 });
    assert_close(&metrics, Metric::SettleTime, 7.001);
}

#[test]
fn run_that_ends_outside_the_band_never_settles() {
    let metrics = error(10.0, |t_s| if t_s > 9.9985 { 0.051 } else { 0.0 });
    assert_eq!(metrics.get(Metric::SettleTime), Measured::Never);
}

#[test]
fn error_on_the_edge_of_the_band_is_inside() {
    let mut measurement = Measurement::new(PERIOD_S, &signals());
    measurement.push(&Sample { load_position_rad: -0.05, ..at_rest(0.0) });
    assert_close(&measurement.metrics(), Metric::SettleTime, 0.0);
}

#[test]
fn static_error_is_the_signed_mean_of_the_last_second() {
    // A ramp of -1 rad/s: over the last 1000 samples its mean is that of 9.0 to 9.999 s.
    assert_close(&error(10.0, |t_s| -t_s), Metric::StaticError, -9.4995);
}

#[test]
fn hunting_is_peak_to_peak_over_the_last_ten_seconds() {
    let metrics = error(20.0, |t_s| if t_s < 9.9995 { 5.0 } else { (0.1 * t_s - 1.0) * 0.01 });
    assert_close(&metrics, Metric::Hunting, 0.009_999);
}

#[test]
fn hunting_of_a_short_run_leaves_out_its_transient() {
    for seconds in [10.0, 12.0, 19.0] {
        let metrics =
            error(seconds, |t_s| if t_s < 0.5 * seconds - 5e-4 { 5.0 } else { 0.01 * (t_s / seconds) });
        assert_close(&metrics, Metric::Hunting, 0.01 * (0.5 - 0.001 / seconds));
    }
    assert_eq!(error(9.999, |_| 0.0).get(Metric::Hunting), Measured::RunTooShort);
}

#[test]
fn overshoot_counts_the_far_side_of_the_reference() {
    let swing = |t_s: f64| if t_s < 1.0 { 2.0 } else { -0.2 * (-t_s).exp() };
    assert_close(&error(10.0, swing), Metric::Overshoot, 0.2 * (-1.0_f64).exp());
    assert_close(&error(10.0, |t_s| -swing(t_s)), Metric::Overshoot, 0.2 * (-1.0_f64).exp());
    // A growing error on the near side isn't overshoot.
    assert_close(&error(10.0, |t_s| 1.0 + t_s), Metric::Overshoot, 0.0);
}

#[test]
fn effort_and_variation_follow_the_held_torque() {
    // 2 N m for half of 10 s, -1 N m for the rest: 4 * 5 + 1 * 5, and one change of 3 N m.
    let metrics = run(10.0, |_| 0.0, |t_s| if t_s < 4.9995 { 2.0 } else { -1.0 });
    assert_close(&metrics, Metric::Effort, 25.0);
    assert_close(&metrics, Metric::TorqueTotalVariation, 3.0);
}

#[test]
fn run_shorter_than_a_window_has_no_metric_of_that_window() {
    let metrics = error(0.999, |_| 0.01);
    assert_eq!(metrics.get(Metric::StaticError), Measured::RunTooShort);
    assert_eq!(metrics.get(Metric::Hunting), Measured::RunTooShort);
    assert_close(&metrics, Metric::SettleTime, 0.0);
    let metrics = error(1.0, |_| 0.01);
    assert_close(&metrics, Metric::StaticError, 0.01);
    assert_eq!(error(9.999, |_| 0.0).get(Metric::Hunting), Measured::RunTooShort);
    assert_close(&error(10.0, |_| 0.0), Metric::Hunting, 0.0);
}

#[test]
fn run_without_samples_has_no_metric() {
    let metrics = Measurement::new(PERIOD_S, &signals()).metrics();
    assert!(metrics.iter().all(|(_, measured)| measured == Measured::RunTooShort));
}

#[test]
fn relative_metrics_need_an_initial_error() {
    let metrics = error(10.0, |t_s| if t_s < 1.0 { 0.0 } else { 0.3 });
    for metric in [Metric::SettleTime5Pct, Metric::SettleTime2Pct, Metric::SettleTime1Pct] {
        assert_eq!(metrics.get(metric), Measured::NoInitialError);
    }
    assert_eq!(metrics.get(Metric::Overshoot), Measured::NoInitialError);
}

#[test]
fn sample_that_is_not_finite_takes_every_metric_of_the_run() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for at_s in [0.0, 5.0, 19.999] {
            let is_bad = move |t_s: f64| (t_s - at_s).abs() < 1e-9;
            let in_position = error(20.0, |t_s| if is_bad(t_s) { bad } else { 0.0 });
            let in_torque = run(20.0, |_| 0.0, |t_s| if is_bad(t_s) { bad } else { 0.0 });
            for metrics in [in_position, in_torque] {
                assert!(!metrics.run_was_finite());
                for (metric, measured) in metrics.iter() {
                    assert_eq!(measured, Measured::NotFinite, "{metric} with {bad} at {at_s} s");
                }
            }
        }
    }
}

#[test]
fn finite_divergence_is_scored_by_its_size() {
    let metrics = run(20.0, |t_s| (10.0 * t_s).exp(), |t_s| (30.0 * t_s).exp());
    assert_eq!(metrics.get(Metric::SettleTime), Measured::Never);
    assert!(metrics.get(Metric::StaticError).value().is_some_and(|error_rad| error_rad > 1e80));
    // The torque is finite, its square isn't.
    assert_eq!(metrics.get(Metric::Effort), Measured::NotFinite);
}

#[test]
fn plant_that_failed_takes_every_metric_of_the_run() {
    let mut measurement = Measurement::new(PERIOD_S, &signals());
    for step in 0..20_000 {
        let load_position_rad = if step == 0 { 1.0 } else { 0.0 };
        measurement.push(&Sample { load_position_rad, ..at_rest(f64::from(step) * PERIOD_S) });
    }
    assert_close(&measurement.metrics(), Metric::SettleTime, 0.001);
    measurement.diverged();
    let metrics = measurement.metrics();
    assert!(!metrics.run_was_finite());
    assert!(metrics.iter().all(|(_, measured)| measured == Measured::NotFinite));
}

/// A load that lags by `lag_rad` behind a triangle of +-1 rad around 0.5 rad with a period of 4 s.
fn behind_a_triangle(seconds: f64, lag_rad: f64, middle_rad: Option<f64>) -> Metrics {
    let reference = match middle_rad {
        Some(offset_rad) => {
            Reference::Sine { amplitude_rad: 1.0, frequency_hz: 0.25, offset_rad, phase_rad: 0.0 }
        }
        None => Reference::Constant { position_rad: 0.5 },
    };
    let signals = signals();
    let steps = fixture::steps(seconds);
    let plan = Plan { period_s: PERIOD_S, steps, reference: Some(&reference), signals: &signals };
    let mut measurement = Measurement::of_run(&plan, []);
    for step in 0..steps {
        // Offset by half a period, so that the passages lie between samples.
        let time_s = (f64::from(step) + 0.5) * PERIOD_S;
        let phase = (time_s + 1.0).rem_euclid(4.0);
        let upwards = phase < 2.0;
        let reference_rad = 0.5 + if upwards { phase - 1.0 } else { 3.0 - phase };
        measurement.push(&Sample {
            reference_rad,
            load_position_rad: reference_rad - if upwards { lag_rad } else { -lag_rad },
            ..at_rest(time_s)
        });
    }
    measurement.metrics()
}

#[test]
fn lost_motion_is_the_distance_between_both_passages() {
    // The reference passes 0.5 rad downwards at 2 s and upwards at 4 s.
    assert_close(&behind_a_triangle(5.0, 0.07, Some(0.5)), Metric::LostMotion, 0.14);
    assert_close(&behind_a_triangle(5.0, 0.0, Some(0.5)), Metric::LostMotion, 0.0);
}

#[test]
fn reference_without_reversal_has_no_lost_motion() {
    for (seconds, middle_rad) in [(3.0, Some(0.5)), (5.0, Some(9.0)), (5.0, None)] {
        let metrics = behind_a_triangle(seconds, 0.07, middle_rad);
        assert_eq!(metrics.get(Metric::LostMotion), Measured::NoReversal, "{seconds} s, {middle_rad:?}");
    }
}

#[test]
fn dead_zone_error_is_the_estimate_less_the_true_half_gap() {
    assert_close(&error(1.0, |_| 0.0), Metric::DeadZoneError, 0.06);
}

#[test]
fn estimate_that_is_nan_takes_its_own_metrics_only() {
    let mut measurement = Measurement::new(PERIOD_S, &signals());
    measurement.push(&Sample {
        load_position_rad: 1.0,
        torque_nm: 1.0,
        drive: Some(&[f64::NAN, 0.0]),
        ..at_rest(0.0)
    });
    let metrics = measurement.metrics();
    assert_eq!(metrics.get(Metric::DeadZoneEstimate), Measured::NotFinite);
    assert_eq!(metrics.get(Metric::DeadZoneError), Measured::NotFinite);
    assert_eq!(metrics.get(Metric::TorqueTotalVariation), Measured::Value(0.0));
    assert!(metrics.run_was_finite());
}
