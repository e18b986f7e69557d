//! The whole law, sample by sample.

use std::string::ToString;

use super::gains::BacklashInverseGains;
use super::inverse::{BacklashInverse, BacklashInverseSetting};
use crate::control::cascade_signals::CascadeSignals;
use crate::control::dead_zone_observer::DeadZoneBounds;
use crate::control::nominal_model::NominalModel;
use crate::law::{ControlOutput, Measurement};

const LSB_RAD: f64 = core::f64::consts::TAU / 4000.0;

fn setting() -> BacklashInverseSetting<f64> {
    BacklashInverseSetting {
        momentum_observer_rad_s: 60.0,
        dead_zone: DeadZoneBounds::default(),
        motor_resolution_rad: 1e-6,
        load_resolution_rad: LSB_RAD,
        torque_limit_nm: 20.0,
        period_s: 1e-3,
    }
}

fn law() -> BacklashInverse<f64> {
    BacklashInverse::new(&NominalModel::default(), BacklashInverseGains::default(), setting()).expect("valid")
}

/// The last output after `samples` identical measurements.
fn output_after(m: Measurement<f64>, samples: usize) -> ControlOutput<CascadeSignals<f64>, f64> {
    let mut law = law();
    (0..samples).map(|_| law.step(&m)).last().expect("at least one sample")
}

#[test]
fn at_rest_on_the_reference_the_torque_is_zero() {
    let anywhere = Measurement {
        load_position_rad: 40.0,
        reference_position_rad: 40.0,
        motor_position_rad: 120.0,
        ..Measurement::default()
    };
    let output = output_after(anywhere, 100);
    assert_eq!(
        (output.torque_nm, output.signals.load_error_rad, output.signals.motor_error_rad),
        (0.0, 0.0, 0.0)
    );
}

#[test]
fn the_motor_leads_the_wanted_torque_by_the_gap() {
    // 0.1 rad off the reference the load loop wants a torque that needs contact.
    let off_reference = Measurement { load_position_rad: -0.1, ..Measurement::default() };
    let output = output_after(off_reference, 1);
    // (f_s + D_v) lam e / N0, with nothing integrated yet.
    let wanted_nm = 46.0 * 2.5 * 0.1 / 3.0;
    let twist_rad = wanted_nm / 1.0 + 0.16;
    assert!(
        (output.signals.motor_error_rad + twist_rad).abs() < 1e-12,
        "have {}",
        output.signals.motor_error_rad
    );
    assert!((output.signals.elastic_error_nm + twist_rad).abs() < 1e-12, "at 1 N m/rad");
    assert!((output.torque_nm - (wanted_nm + 1.0 * twist_rad)).abs() < 1e-12, "have {}", output.torque_nm);
}

#[test]
fn a_torque_below_the_crossing_moves_the_motor_part_of_the_gap() {
    // 2.5 mrad request 0.0958 N m: half of the gap at a crossing twice as wide.
    let off_reference = Measurement { load_position_rad: -0.0025, ..Measurement::default() };
    let wanted_nm = 46.0 * 2.5 * 0.0025 / 3.0;
    let gains = BacklashInverseGains { gap_crossing_nm: 2.0 * wanted_nm, ..BacklashInverseGains::default() };
    let mut law = BacklashInverse::new(&NominalModel::default(), gains, setting()).expect("valid");
    let output = law.step(&off_reference);
    assert!(
        (output.signals.motor_error_rad + wanted_nm + 0.08).abs() < 1e-12,
        "have {}",
        output.signals.motor_error_rad
    );
}

#[test]
fn disturbing_torque_is_the_transmitted_less_the_spring_torque() {
    // At a twist of 1.66 rad the paper's machine transmits 1.5 N m: w = 1.5 - 1.66 N m.
    let wound = Measurement { twist_rad: 1.66, applied_torque_nm: 1.5, ..Measurement::default() };
    let output = output_after(Measurement { motor_position_rad: 1.66, ..wound }, 2000);
    assert!(
        (output.signals.disturbing_torque_estimate_nm + 0.16).abs() < 1e-9,
        "have {} N m",
        output.signals.disturbing_torque_estimate_nm
    );
    assert!((output.signals.dead_zone_estimate_rad - 0.16).abs() < 1e-9);
}

#[test]
fn load_friction_does_not_bias_the_gap_estimate() {
    // Friction holds the load at any spring torque: |z| = |C| / K + 0.1.
    let mut law = law();
    let mut output = None;
    for k in 0..40_000 {
        let torque = 3.0 * (f64::from(k) * 5e-4).sin();
        let twist = torque + 0.1 * torque.signum();
        let wound = Measurement {
            applied_torque_nm: torque,
            twist_rad: twist,
            motor_position_rad: twist,
            motor_velocity_rad_s: 1.5 * (f64::from(k) * 5e-4).cos(),
            ..Measurement::default()
        };
        output = Some(law.step(&Measurement { load_position_rad: -0.5, ..wound }));
    }
    let have = output.expect("stepped").signals.dead_zone_estimate_rad;
    assert!((have - 0.1).abs() < 5e-3, "have {have} rad, want 0.1");
}

#[test]
fn the_estimate_is_frozen_during_a_hold() {
    let estimate_rad_at = |load_position_rad: f64| {
        let mut law = law();
        let output = (0..5000).map(|k| {
            law.step(&Measurement {
                load_position_rad,
                twist_rad: 3.0,
                applied_torque_nm: 1.5,
                motor_position_rad: 1e-3 * f64::from(k),
                motor_velocity_rad_s: 1.0,
                ..Measurement::default()
            })
        });
        output.last().expect("stepped").signals.dead_zone_estimate_rad
    };
    assert_eq!(estimate_rad_at(0.0), 0.16, "a hold on the reference");
    let off_reference_rad = estimate_rad_at(0.1);
    assert!(off_reference_rad > 0.2, "{off_reference_rad} rad off the reference");
}

#[test]
fn the_drive_limit_bounds_the_transmitted_torque() {
    let far = Measurement { load_position_rad: -2.0, ..Measurement::default() };
    let weak = BacklashInverseSetting { torque_limit_nm: 2.0, ..setting() };
    for (setting, limit_nm) in [(setting(), 8.0), (weak, 2.0)] {
        let mut law =
            BacklashInverse::new(&NominalModel::default(), BacklashInverseGains::default(), setting)
                .expect("valid");
        let output = law.step(&far);
        assert!(
            (output.signals.motor_error_rad + limit_nm + 0.16).abs() < 1e-12,
            "{}",
            output.signals.motor_error_rad
        );
    }
}

#[test]
fn the_other_direction_is_the_mirror_image() {
    let (mut law, mut mirrored) = (law(), law());
    for k in 0..3000 {
        let t = f64::from(k) * 1e-3;
        let m = Measurement {
            motor_position_rad: 3.0 * t.sin() + t,
            motor_velocity_rad_s: 3.0 * t.cos() + 1.0,
            load_position_rad: t.sin(),
            twist_rad: t,
            reference_position_rad: 0.3,
            applied_torque_nm: 2.0 * t,
            ..Measurement::default()
        };
        let other = Measurement {
            motor_position_rad: -m.motor_position_rad,
            motor_velocity_rad_s: -m.motor_velocity_rad_s,
            load_position_rad: -m.load_position_rad,
            twist_rad: -m.twist_rad,
            reference_position_rad: -m.reference_position_rad,
            applied_torque_nm: -m.applied_torque_nm,
            ..Measurement::default()
        };
        let (one, two) = (law.step(&m), mirrored.step(&other));
        assert_eq!(one.torque_nm, -two.torque_nm, "sample {k}");
        assert_eq!(one.signals.dead_zone_estimate_rad, two.signals.dead_zone_estimate_rad, "sample {k}");
    }
}

#[test]
fn inconsistent_gains_are_rejected_by_name() {
    let rejected = |gains, setting| {
        BacklashInverse::new(&NominalModel::default(), gains, setting).expect_err("rejected").to_string()
    };
    let gains = BacklashInverseGains::default();
    let damped = BacklashInverseGains { twist_damping_nm_s_rad: 0.1, ..gains };
    let slow = BacklashInverseSetting { period_s: 0.01, ..setting() };
    assert_eq!(
        rejected(damped, slow),
        "control parameter twist_damping_nm_s_rad is 0.1, allowed is at most 0.0972, \
         given by motor_inertia_kg_m2 over the control period"
    );
    let fast = BacklashInverseGains { load_observer_rad_s: 51.0, ..gains };
    assert_eq!(
        rejected(fast, slow),
        "control parameter load_observer_rad_s is 51, allowed is at most 50, \
         given by half of 1 over the control period"
    );
    let dead_zone = DeadZoneBounds { dead_zone_initial_rad: 3.5, ..DeadZoneBounds::default() };
    let wide = BacklashInverseSetting { dead_zone, ..setting() };
    assert_eq!(
        rejected(gains, wide),
        "control parameter dead_zone_initial_rad is 3.5, allowed is at most 3, given by dead_zone_max_rad"
    );
    let missing = BacklashInverseGains { load_observer_rad_s: f64::NAN, ..gains };
    assert!(rejected(missing, setting()).starts_with("control parameter load_observer_rad_s is NaN"));
}
