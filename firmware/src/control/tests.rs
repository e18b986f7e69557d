//! The laws compared with each other.

use core::f64::consts::FRAC_PI_2;
use std::boxed::Box;

use super::backlash_inverse::{BacklashInverse, BacklashInverseGains, BacklashInverseSetting};
use super::cascade::CascadeGains;
use super::cascade_signals::CascadeSignals;
use super::dead_zone_observer::{DeadZoneBounds, DeadZoneObserver};
use super::merzouki::{DisturbingTorqueSource, Merzouki};
use super::momentum_observer::MomentumObserver;
use super::nominal_model::NominalModel;
use super::pd::Pd;
use crate::law::{ControlOutput, Measurement};

type Step = Box<dyn FnMut(&Measurement<f64>) -> ControlOutput<CascadeSignals<f64>, f64>>;

/// The paper's start: at rest, the load at pi/2 and the motor at 3 pi/2.
fn start() -> Measurement<f64> {
    Measurement {
        motor_position_rad: 3.0 * FRAC_PI_2,
        load_position_rad: FRAC_PI_2,
        ..Measurement::default()
    }
}

fn backlash_inverse() -> Step {
    let setting = BacklashInverseSetting {
        momentum_observer_rad_s: 60.0,
        dead_zone: DeadZoneBounds::default(),
        motor_resolution_rad: 1e-6,
        load_resolution_rad: 1e-4,
        torque_limit_nm: 20.0,
        period_s: 1e-3,
    };
    let law = BacklashInverse::new(&NominalModel::default(), BacklashInverseGains::default(), setting);
    let mut law = law.expect("valid");
    Box::new(move |measurement| law.step(measurement))
}

/// The laws of the paper.
fn laws() -> [Step; 3] {
    let (model, gains) = (NominalModel::default(), CascadeGains::default());
    let (observer, bounds) = (DeadZoneObserver::default(), DeadZoneBounds::default());
    let observed = DisturbingTorqueSource::Observed(MomentumObserver::new(&model, 60.0, 1e-3));
    let merzouki = |source| -> Step {
        let mut law = Merzouki::new(&model, gains, observer, bounds, source, 1e-3).expect("valid");
        Box::new(move |measurement| law.step(measurement))
    };
    let pd = Pd::new(&model, gains);
    let as_printed = merzouki(DisturbingTorqueSource::AsPrinted);
    [Box::new(move |measurement| pd.step(measurement)), merzouki(observed), as_printed]
}

#[test]
fn without_twist_every_law_of_the_paper_gives_one_torque() {
    for mut law in laws() {
        let output = law(&start());
        // Without twist the compensation is zero: -(theta_e + 10 theta_s).
        assert!((output.torque_nm + 13.0 * FRAC_PI_2).abs() < 1e-9, "have {} N m", output.torque_nm);
        assert_eq!(output.signals.dead_zone_estimate_rad, 0.16);
    }
}

#[test]
fn laws_differ_by_lead_and_free_torque_at_a_wound_spring() {
    let wound = Measurement { twist_rad: 2.0, motor_position_rad: 3.0 * FRAC_PI_2 + 2.0, ..start() };
    let [pd, merzouki, as_printed] = laws().map(|mut law| law(&wound).torque_nm);
    let w_hat = -0.64 * libm::tanh(2.0 / 0.64);
    assert!((as_printed - (pd - w_hat)).abs() < 1e-12, "merzouki-as-printed: have {as_printed}, pd {pd}");
    // Lead -w_hat, and w - w_hat before any observation: C_obs = 0, w = -K z.
    assert!(
        (merzouki - (pd - w_hat - w_hat - 2.0 - w_hat)).abs() < 1e-12,
        "merzouki: have {merzouki}, pd {pd}"
    );
}

#[test]
fn merzouki_laws_use_the_estimate_from_before_its_update() {
    let wound = Measurement { twist_rad: 2.0, ..start() };
    for mut law in laws().into_iter().skip(1) {
        let first = law(&wound);
        let second = law(&wound);
        assert_eq!(first.signals.dead_zone_estimate_rad, 0.16);
        let rate = 0.01 * first.signals.load_error_rad + 0.5 * first.signals.elastic_error_nm;
        assert!((second.signals.dead_zone_estimate_rad - 0.16 - 1e-3 * rate).abs() < 1e-15);
    }
}

#[test]
fn perfect_tracking_needs_the_torque_of_the_rigid_mechanics() {
    // On the reference in position and velocity, the spring wound by exactly zeta_d and the motor at the position
    // of (17), only the feed-forward remains.
    let moving = Measurement {
        motor_position_rad: 3.0,
        motor_velocity_rad_s: 1.5,
        load_position_rad: 1.0,
        load_velocity_rad_s: 0.5,
        twist_rad: (7.5 * 0.2 + 16.0 * 0.5) / 3.0,
        reference_position_rad: 1.0,
        reference_velocity_rad_s: 0.5,
        reference_acceleration_rad_s2: 0.2,
        applied_torque_nm: 0.0,
    };
    let [mut pd, ..] = laws();
    let want = (9.72e-4 * 3.0 + 7.5 / 3.0) * 0.2 + (4.3e-4 * 3.0 + 16.0 / 3.0) * 0.5;
    let have = pd(&moving).torque_nm;
    assert!((have - want).abs() < 1e-12, "have {have}, want {want} N m");
}

#[test]
fn a_measurement_of_nan_makes_the_torque_non_finite() {
    for mut law in laws().into_iter().chain([backlash_inverse()]) {
        let invalid = Measurement { load_position_rad: f64::NAN, ..start() };
        assert!(!law(&invalid).torque_nm.is_finite());
    }
}
