//! LuGre friction on the load of the bench.

use core::f64::consts::PI;

use lashloop_plant::backlash_shaft::{BristleParameters, Environment, ShaftParameters};
use lashloop_plant::{PlantError, RunningPlant, Start, Truth};

use crate::backlash::{recorded_imbalance, truths};
use crate::closed_loop::{Ideal, Timing, regulate_to_nought, run};
use crate::paper;

fn bristles(stiffness_nm_rad: f64) -> ShaftParameters {
    ShaftParameters {
        load_bristles: Some(BristleParameters { stiffness_nm_rad, damping_nm_s_rad: 300.0 }),
        ..paper::unlimited()
    }
}

/// The load alone, under a torque from outside, for so many milliseconds from rest.
fn under_load_torque(parameters: ShaftParameters, torque_nm: impl Fn(f64) -> f64, steps: u32) -> Truth {
    let mut plant = RunningPlant::released(paper::bench_with(parameters, 16), Start::at_rest(0.0, 0.0));
    for k in 0..steps {
        let load_torque_nm = torque_nm(f64::from(k) * 1e-3);
        let environment = Environment { dead_zone_rad: 10.0, load_torque_nm };
        plant.set_environment(environment).expect("in range");
        plant.step(0.0, 1e-3).expect("the plant steps");
    }
    plant.truth()
}

/// From nought to one without a corner.
fn gently(share: f64) -> f64 {
    (0.5 * PI * share.min(1.0)).sin().powi(2)
}

#[test]
fn bristles_hold_a_small_load_like_a_spring_that_slides_a_little() {
    // Pushed slowly, dx = dtheta (1 - sigma_0 x / F_s) and F = sigma_0 x: theta = -(F_s / sigma_0) ln(1 - F / F_s).
    for torque_nm in [0.1, 1.7, 3.0] {
        let truth = under_load_torque(bristles(3.4e4), |time_s| torque_nm * gently(0.2 * time_s), 6_000);
        let want = -(3.82 / 3.4e4) * (1.0 - torque_nm / 3.82_f64).ln();
        let have = truth.load_position_rad;
        assert!((have / want - 1.0).abs() < 0.01, "{torque_nm} N m: have {have}, want {want} rad");
        assert!((truth.load_dry_friction_nm - torque_nm).abs() < 1e-3, "{truth:?}");
    }
}

#[test]
fn sliding_bristles_carry_the_friction_of_stribecks_curve() {
    // Steady sliding: the torque less the viscous part is F_c + (F_s - F_c) exp(-(v / v_s)^2).
    for torque_nm in [4.2, 5.0, 8.0] {
        let truth = under_load_torque(bristles(3.4e4), |_| torque_nm, 6_000);
        let v = truth.load_velocity_rad_s;
        let want = 3.40 + 0.42 * (-(v / 0.03_f64).powi(2)).exp();
        assert!((truth.load_dry_friction_nm / want - 1.0).abs() < 1e-6, "{truth:?}, want {want} N m");
        assert!((16.0 * v + want - torque_nm).abs() < 1e-3 * torque_nm, "{truth:?}");
    }
}

#[test]
fn energy_of_bristles_balances_however_stiff_they_are() {
    for (stiffness_nm_rad, bound) in [(3.4e3, 3e-11), (3.4e4, 3e-11), (3.4e5, 3e-11)] {
        let truths = truths(&paper::bench_with(bristles(stiffness_nm_rad), 16), 1e-3, 8_000);
        let imbalance = recorded_imbalance(&truths);
        assert!(imbalance < bound, "{stiffness_nm_rad} N m/rad: have {imbalance:e}, want below {bound:e}");
    }
}

#[test]
fn stiffer_bristles_take_more_substeps_and_in_the_end_are_refused() {
    let substeps = |stiffness| paper::bench_with(bristles(stiffness), 1).substeps(1e-3, 0.5);
    assert!(matches!(substeps(3.4e4), Ok(2..=8)));
    assert!(matches!(substeps(3.4e5), Ok(16..=64)));
    let refused = substeps(1e9);
    assert!(matches!(refused, Err(PlantError::TooStiff { .. })), "{refused:?}");
}

#[test]
fn bristles_stop_pd_where_stick_and_slip_do() {
    let last = |parameters| {
        let law = paper::pd::<f64>();
        let rows = run(
            &paper::bench_with(parameters, 16),
            paper::START,
            &law,
            Ideal,
            regulate_to_nought,
            Timing::RECORDED,
        );
        rows.last().expect("rows").truth.load_position_rad
    };
    let [stuck, bent] = [last(paper::unlimited()), last(bristles(3.4e4))];
    assert!((stuck - bent).abs() < 0.01, "sticking stops at {stuck} rad, bristles at {bent} rad");
}
