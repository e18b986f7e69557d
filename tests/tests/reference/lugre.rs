//! LuGre friction on the load of the backlash shaft.

use core::f64::consts::PI;

use lashloop_plant::backlash_shaft::{BristleParameters, ShaftParameters};
use lashloop_plant::{Environment, PlantError, RunningPlant, Start, Truth};

use crate::backlash_shaft::{recorded_imbalance, truths};
use crate::closed_loop::{Ideal, Timing, regulate_to_zero, run};
use crate::paper;

fn bristles(stiffness_nm_rad: f64) -> ShaftParameters {
    ShaftParameters {
        load_bristles: Some(BristleParameters { stiffness_nm_rad, damping_nm_s_rad: 300.0 }),
        ..paper::unlimited()
    }
}

/// The load alone under an external torque, after `steps` milliseconds from rest.
fn under_load_torque(parameters: ShaftParameters, torque_nm: impl Fn(f64) -> f64, steps: u32) -> Truth {
    let mut plant =
        RunningPlant::released(paper::backlash_shaft_with(parameters, 16), Start::at_rest(0.0, 0.0));
    for k in 0..steps {
        let load_torque_nm = torque_nm(f64::from(k) * 1e-3);
        let environment = Environment { gap_growth_rad: 9.0, load_torque_nm };
        plant.set_environment(environment).expect("in range");
        plant.step(0.0, 1e-3).expect("the plant steps");
    }
    plant.truth()
}

/// A smooth rise from zero to one.
fn smooth_rise(fraction: f64) -> f64 {
    (0.5 * PI * fraction.min(1.0)).sin().powi(2)
}

#[test]
fn bristles_hold_a_small_load_with_presliding_motion() {
    // Pushed slowly, dx = dtheta (1 - sigma_0 x / F_s) and F = sigma_0 x: theta = -(F_s / sigma_0) ln(1 - F / F_s).
    for torque_nm in [0.1, 1.7, 3.0] {
        let truth = under_load_torque(bristles(3.4e4), |time_s| torque_nm * smooth_rise(0.2 * time_s), 6_000);
        let want = -(3.82 / 3.4e4) * (1.0 - torque_nm / 3.82_f64).ln();
        let have = truth.load_position_rad;
        assert!((have / want - 1.0).abs() < 0.01, "{torque_nm} N m: have {have}, want {want} rad");
        assert!((truth.load_dry_friction_nm - torque_nm).abs() < 1e-3, "{truth:?}");
    }
}

#[test]
fn sliding_bristles_follow_the_stribeck_curve() {
    // Steady sliding: the torque minus the viscous part is F_c + (F_s - F_c) exp(-(v / v_s)^2).
    for torque_nm in [4.2, 5.0, 8.0] {
        let truth = under_load_torque(bristles(3.4e4), |_| torque_nm, 6_000);
        let v = truth.load_velocity_rad_s;
        let want = 3.40 + 0.42 * (-(v / 0.03_f64).powi(2)).exp();
        assert!((truth.load_dry_friction_nm / want - 1.0).abs() < 1e-6, "{truth:?}, want {want} N m");
        assert!((16.0 * v + want - torque_nm).abs() < 1e-3 * torque_nm, "{truth:?}");
    }
}

#[test]
fn energy_balances_for_bristles_of_any_stiffness() {
    for (stiffness_nm_rad, bound) in [(3.4e3, 3e-11), (3.4e4, 3e-11), (3.4e5, 3e-11)] {
        let truths = truths(&paper::backlash_shaft_with(bristles(stiffness_nm_rad), 16), 1e-3, 8_000);
        let imbalance = recorded_imbalance(&truths);
        assert!(imbalance < bound, "{stiffness_nm_rad} N m/rad: have {imbalance:e}, want below {bound:e}");
    }
}

#[test]
fn stiffer_bristles_need_more_substeps_up_to_the_limit() {
    let substeps = |stiffness| paper::backlash_shaft_with(bristles(stiffness), 1).substeps(1e-3, 0.5);
    assert!(matches!(substeps(3.4e4), Ok(2..=8)));
    assert!(matches!(substeps(3.4e5), Ok(16..=64)));
    let rejected = substeps(1e9);
    assert!(matches!(rejected, Err(PlantError::TooStiff { .. })), "{rejected:?}");
}

#[test]
fn pd_stops_on_bristles_where_it_stops_on_stiction() {
    let last = |parameters| {
        let law = paper::pd::<f64>();
        let rows = run(
            &paper::backlash_shaft_with(parameters, 16),
            paper::START,
            &law,
            Ideal,
            regulate_to_zero,
            Timing::RECORDED,
        );
        rows.last().expect("rows").truth.load_position_rad
    };
    let [stuck, bent] = [last(paper::unlimited()), last(bristles(3.4e4))];
    assert!((stuck - bent).abs() < 0.01, "sticking stops at {stuck} rad, bristles at {bent} rad");
}
