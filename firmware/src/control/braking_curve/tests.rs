//! The law and its load loop, sample by sample.

use std::string::ToString;

use super::gains::BrakingCurveGains;
use super::law::{BrakingCurve, BrakingCurveSetting, LEARNT_DEVIATION_RAD};
use super::load_loop::{LoadLoop, LoadLoopState};
use crate::control::dead_zone_observer::DeadZoneBounds;
use crate::control::load_observer::ObservedLoad;
use crate::control::nominal_model::NominalModel;
use crate::law::Measurement;

fn setting() -> BrakingCurveSetting<f64> {
    BrakingCurveSetting {
        dead_zone: DeadZoneBounds::default(),
        load_resolution_rad: 1e-6,
        torque_limit_nm: 20.0,
        period_s: 1e-3,
    }
}

fn law() -> BrakingCurve<f64> {
    BrakingCurve::new(&NominalModel::default(), BrakingCurveGains::default(), setting()).expect("valid")
}

fn load_loop(torque_limit_nm: f64) -> LoadLoop<f64> {
    LoadLoop::new(&NominalModel::default(), BrakingCurveGains::default(), 1e-6, torque_limit_nm, 1e-3)
}

/// The commanded torque after `samples` of a load at rest at this position, against this lasting load.
fn at_rest(
    load_loop: &LoadLoop<f64>,
    state: &mut LoadLoopState<f64>,
    load_position_rad: f64,
    disturbance_nm: f64,
    samples: u32,
) -> f64 {
    let m = Measurement { load_position_rad, ..Measurement::default() };
    let load = ObservedLoad { velocity_rad_s: 0.0, disturbance_nm, transmitted_nm: 0.0 };
    (0..samples).map(|_| load_loop.step(state, &m, &load)).last().expect("at least one sample")
}

#[test]
fn command_uses_at_most_the_winding_limit_and_95_percent_of_the_drive_s() {
    for (torque_limit_nm, want_nm) in [(20.0, 18.0), (10.0, 9.5), (2.0, 1.9)] {
        let have_nm = at_rest(&load_loop(torque_limit_nm), &mut LoadLoop::initial_state(), -2.0, 0.0, 1);
        assert_eq!(have_nm, want_nm, "limit of {torque_limit_nm} N m");
    }
}

#[test]
fn arrival_unloads_the_integral_once_and_departure_releases_the_hold() {
    let (load_loop, mut state) = (load_loop(20.0), LoadLoop::initial_state());
    // 10 mrad short of the target, at standstill, the integral grows beyond its limit of 7.2 N m at the load.
    let approaching_nm = at_rest(&load_loop, &mut state, -0.01, 0.0, 3000);
    assert!(approaching_nm > 2.4 && !state.holding, "{approaching_nm} N m");
    let before_nm = at_rest(&load_loop, &mut state, -0.0019, 0.0, 1);
    assert!(state.holding);
    let held_nm = at_rest(&load_loop, &mut state, -0.0019, 0.0, 5000);
    assert_eq!(before_nm, held_nm, "the integral is frozen");
    assert!(held_nm < 0.35 * approaching_nm, "{held_nm} N m after {approaching_nm} N m");
    at_rest(&load_loop, &mut state, -0.0039, 0.0, 1);
    assert!(state.holding, "within two bands");
    at_rest(&load_loop, &mut state, -0.0041, 0.0, 1);
    assert!(!state.holding, "beyond two bands");
}

#[test]
fn lasting_load_beyond_stiction_is_not_unloaded() {
    let (load_loop, mut state) = (load_loop(20.0), LoadLoop::initial_state());
    // An integral of more than 7.2 N m at the load, of which 0.3 would be less than the load needs.
    at_rest(&load_loop, &mut state, -0.01, 12.0, 2200);
    let held_nm = at_rest(&load_loop, &mut state, 0.0, 12.0, 1);
    // 12 N m at the load, less at most the stiction of 1.4 * 3.4 N m that may help.
    assert!(3.0 * held_nm > 12.0 - 1.4 * 3.4, "{held_nm} N m at the motor");
}

#[test]
fn integral_s_limit_grows_at_standstill_only() {
    let (load_loop, m) =
        (load_loop(20.0), Measurement { load_position_rad: -0.01, ..Measurement::default() });
    for (velocity_rad_s, grows) in [(0.0, true), (-0.05, false)] {
        let load = ObservedLoad { velocity_rad_s, disturbance_nm: 0.0, transmitted_nm: 0.0 };
        let mut state = LoadLoop::initial_state();
        // After 2 s the integral has reached its limit of 7.2 N m.
        let [early_nm, late_nm] =
            [2000, 2000].map(|samples| (0..samples).map(|_| load_loop.step(&mut state, &m, &load)).last());
        let (early_nm, late_nm) = (early_nm.expect("samples"), late_nm.expect("samples"));
        assert_eq!(
            late_nm > early_nm + 2.0,
            grows,
            "{velocity_rad_s} rad/s: from {early_nm} to {late_nm} N m"
        );
        assert!(grows || late_nm == early_nm, "{velocity_rad_s} rad/s: from {early_nm} to {late_nm} N m");
    }
}

/// The law's estimate and deviation after torques of this amplitude at a spring with half a gap of 0.1 rad.
fn learnt_at(amplitude_nm: f64) -> (f64, f64) {
    let mut law = law();
    let mut signals = None;
    for k in 0..40_000 {
        let torque = amplitude_nm * (f64::from(k) * 5e-4).sin();
        let wound = Measurement {
            applied_torque_nm: torque,
            twist_rad: torque + 0.1 * torque.signum(),
            load_position_rad: -0.5,
            ..Measurement::default()
        };
        signals = Some(law.step(&wound).signals);
    }
    let signals = signals.expect("stepped");
    (signals.dead_zone_estimate_rad, signals.dead_zone_deviation_rad)
}

#[test]
fn gap_is_claimed_as_learnt_only_after_torque_enough() {
    let (estimate_rad, deviation_rad) = learnt_at(3.0);
    assert!((estimate_rad - 0.1).abs() < 5e-3, "{estimate_rad} rad");
    assert!(deviation_rad <= LEARNT_DEVIATION_RAD, "{deviation_rad} rad");
    // 0.4 N m is the least torque at which contact is certain.
    let (estimate_rad, deviation_rad) = learnt_at(0.39);
    assert_eq!((estimate_rad, deviation_rad), (0.16, 1.0), "the prior value, and nothing learnt");
}

#[test]
fn accelerating_motor_does_not_teach_the_gap() {
    let mut law = law();
    // The torque alternates faster than the observer follows: the motor is never balanced for 19 periods.
    for k in 0..40_000 {
        let torque = if k % 20 < 10 { 6.0 } else { 1.0 };
        let m = Measurement {
            applied_torque_nm: torque,
            twist_rad: 3.5,
            load_position_rad: -0.5,
            ..Measurement::default()
        };
        assert_eq!(law.step(&m).signals.dead_zone_deviation_rad, 1.0, "sample {k}");
    }
}

#[test]
fn inconsistent_gains_are_rejected_by_name() {
    let rejected = |gains| {
        BrakingCurve::new(&NominalModel::default(), gains, setting()).expect_err("rejected").to_string()
    };
    let gains = BrakingCurveGains::default();
    for (gains, name) in [
        (BrakingCurveGains { shaft_damping_nm_s_rad: 1.0, ..gains }, "shaft_damping_nm_s_rad"),
        (BrakingCurveGains { speed_observer_rad_s: 501.0, ..gains }, "speed_observer_rad_s"),
        (BrakingCurveGains { winding_rad_s: 501.0, ..gains }, "winding_rad_s"),
        (BrakingCurveGains { landing_rate_1_s: 10.1, ..gains }, "landing_rate_1_s"),
    ] {
        let message = rejected(gains);
        assert!(message.starts_with(&std::format!("control parameter {name} is ")), "{message}");
    }
}
