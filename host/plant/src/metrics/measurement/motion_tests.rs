//! Moves with metrics in closed form: a load that lags as a first-order system.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use crate::metrics::fixture::{PERIOD_S, assert_metric, at_rest, measure, signals, steps};
use crate::metrics::{Measured, Measurement, Metric, Metrics, Plan, Sample};
use crate::reference::{Reference, Trapezoid};

/// A run along `reference` with a load and a torque that are functions of time.
fn along(
    reference: &Reference,
    seconds: f64,
    load_position_rad: impl Fn(f64) -> f64,
    torque_nm: impl Fn(f64) -> f64,
) -> Metrics {
    let signals = signals();
    let plan =
        Plan { period_s: PERIOD_S, steps: steps(seconds), reference: Some(reference), signals: &signals };
    measure(Measurement::of_run(&plan, []), seconds, |time_s| Sample {
        reference_rad: reference.position_rad(time_s),
        load_position_rad: load_position_rad(time_s),
        torque_nm: torque_nm(time_s),
        ..at_rest(time_s)
    })
}

/// From 0 to 2 rad: 0.5 s of acceleration from 1 s on, 1.5 s at 1 rad/s, 0.5 s of deceleration, at rest from 3.5 s on.
fn trapezoid(to_rad: f64) -> Reference {
    let (start_s, velocity_rad_s, acceleration_rad_s2) = (1.0, 1.0, 2.0);
    Reference::Trapezoid(Trapezoid { from_rad: 0.0, to_rad, start_s, velocity_rad_s, acceleration_rad_s2 })
}

fn step(after_rad: f64) -> Reference {
    Reference::Step { before_rad: 0.0, after_rad, at_s: 1.0 }
}

#[test]
fn first_order_response_rises_in_2_197_time_constants() {
    // 0.3 ln(1 / 0.9) = 31.6 ms and 0.3 ln(10) = 690.8 ms after the step: samples 32 and 691.
    for after_rad in [2.0, -2.0] {
        let load = |t_s: f64| after_rad * (1.0 - (-(t_s - 1.0).max(0.0) / 0.3).exp());
        let metrics = along(&step(after_rad), 5.0, load, |_| 0.0);
        assert_metric(&metrics, Metric::RiseTime, 0.659);
    }
}

#[test]
fn regulation_rises_from_the_first_position_of_the_load() {
    let metrics = along(&Reference::Constant { position_rad: 0.0 }, 5.0, |t_s| (-t_s / 0.3).exp(), |_| 0.0);
    assert_metric(&metrics, Metric::RiseTime, 0.659);
}

#[test]
fn rise_time_needs_a_way_an_end_and_an_arrival() {
    let rise = |reference, load: fn(f64) -> f64| along(&reference, 2.0, load, |_| 0.0).get(Metric::RiseTime);
    assert_eq!(rise(step(0.0), |_| 0.0), Measured::NoInitialError);
    assert_eq!(rise(step(1.0), |_| 0.89), Measured::Never);
    assert_eq!(rise(step(1.0), |t_s| if t_s < 1.5 { 0.0 } else { 0.89 }), Measured::Never);
    // The move ends at 3.5 s, the run at 2 s.
    assert_eq!(rise(trapezoid(2.0), |t_s| t_s), Measured::NoEndOfMotion);
}

#[test]
fn move_settles_into_2_percent_of_its_distance() {
    // 0.5 exp(-t) reaches 2 % of 2 rad at 2.5257 s after the end of the move.
    for to_rad in [2.0, -2.0] {
        let reference = trapezoid(to_rad);
        let load = |t_s: f64| reference.position_rad(t_s) - 0.5 * (-(t_s - 3.5).max(0.0)).exp();
        let metrics = along(&reference, 10.0, load, |_| 0.0);
        assert_metric(&metrics, Metric::SettleAfterMove, 2.526);
    }
    let arrived = along(&trapezoid(2.0), 10.0, |t_s| trapezoid(2.0).position_rad(t_s), |_| 0.0);
    assert_metric(&arrived, Metric::SettleAfterMove, 0.0);
}

#[test]
fn settling_after_a_move_needs_a_move_that_ends() {
    let settle = |reference: &Reference, load: fn(f64) -> f64| {
        along(reference, 3.0, load, |_| 0.0).get(Metric::SettleAfterMove)
    };
    assert_eq!(settle(&Reference::Constant { position_rad: 1.0 }, |_| 0.0), Measured::NoMove);
    assert_eq!(settle(&trapezoid(2.0), |_| 0.0), Measured::NoEndOfMotion);
    assert_eq!(settle(&step(1.0), |_| 0.0), Measured::Never);
    assert_eq!(settle(&step(1.0), |_| 0.981), Measured::Value(0.0));
}

/// Jumps of 1 rad at 1 s and of 0.1 rad at 2 s, which the load follows `delays` later, in steps.
fn two_jumps(delays: [u32; 2]) -> Metrics {
    let mut measurement = Measurement::new(PERIOD_S, &signals());
    let position_rad = |step: u32, [first, second]: [u32; 2]| {
        f64::from(u8::from(step >= 1000 + first)) + 0.1 * f64::from(u8::from(step >= 2000 + second))
    };
    for step in 0..3000 {
        measurement.push(&Sample {
            reference_rad: position_rad(step, [0, 0]),
            load_position_rad: position_rad(step, delays),
            ..at_rest(f64::from(step) * PERIOD_S)
        });
    }
    measurement.metrics()
}

#[test]
fn last_of_several_moves_is_the_one_that_settles() {
    assert_metric(&two_jumps([200, 50]), Metric::SettleAfterMove, 0.05);
}

#[test]
fn every_move_counts_in_the_longest_settling() {
    assert_metric(&two_jumps([200, 50]), Metric::SettleAfterEveryMove, 0.2);
    assert_metric(&two_jumps([50, 200]), Metric::SettleAfterEveryMove, 0.2);
    let missed = two_jumps([1001, 0]).get(Metric::SettleAfterEveryMove);
    assert_eq!(missed, Measured::Never, "the first move did not settle before the second");
}

#[test]
fn first_order_lag_under_a_ramp_is_velocity_times_time_constant() {
    for to_rad in [20.0, -20.0] {
        let reference = trapezoid(to_rad);
        // The steady lag of a first-order system with a time constant of 70 ms.
        let load = |t_s: f64| reference.position_rad(t_s) - 0.07 * to_rad.signum();
        let metrics = along(&reference, 10.0, load, |_| 0.0);
        assert_metric(&metrics, Metric::SteadyVelocityError, 0.07);
        let finished = along(&reference, 30.0, load, |_| 0.0);
        assert_metric(&finished, Metric::SteadyVelocityError, 0.07);
    }
}

#[test]
fn velocity_error_omits_the_start_of_the_stretch() {
    // Constant velocity from 1.5 s to 3 s; the lag is right from 2.7 s on only.
    let reference = trapezoid(2.0);
    let load = |t_s: f64| reference.position_rad(t_s) - if t_s < 2.7 { 1.0 } else { 0.03 };
    assert_metric(&along(&reference, 10.0, load, |_| 0.0), Metric::SteadyVelocityError, 0.03);
}

#[test]
fn reference_without_a_steady_velocity_has_no_velocity_error() {
    let sine = Reference::Sine { amplitude_rad: 0.5, frequency_hz: 0.05, offset_rad: 0.1, phase_rad: 0.0 };
    // 0.1 rad at 1 rad/s and 2 rad/s^2 is over before it reaches the velocity limit.
    for reference in [sine, trapezoid(0.1), step(1.0), Reference::Constant { position_rad: 1.0 }] {
        let metrics = along(&reference, 10.0, |t_s| reference.position_rad(t_s), |_| 0.0);
        assert_eq!(metrics.get(Metric::SteadyVelocityError), Measured::NoSteadyVelocity, "{reference:?}");
    }
}

#[test]
fn sine_has_its_root_mean_square_and_its_peak() {
    let reference = Reference::Constant { position_rad: 1.0 };
    let metrics = along(&reference, 4.0, |t_s| 1.0 + 0.2 * (TAU * t_s).sin(), |t_s| -3.0 * (TAU * t_s).cos());
    assert_metric(&metrics, Metric::RmsTrackingError, 0.2 * FRAC_1_SQRT_2);
    assert_metric(&metrics, Metric::PeakTrackingError, 0.2);
    assert_metric(&metrics, Metric::RmsTorque, 3.0 * FRAC_1_SQRT_2);
    assert_metric(&metrics, Metric::PeakTorque, 3.0);
}
