//! Physical laws on the paper's plants: the smooth gap, and the hard gap with Coulomb friction.

use lashloop_plant::{Contact, DryFriction, Mechanics, Start, Truth, TwoMass};

use crate::closed_loop::{Ideal, Timing, regulate_to_zero, run, slow_sine};
use crate::open_loop::pushed;
use crate::paper;
use crate::trajectory::{Row, lost_motion_rad};

fn hard_coulomb_rows(merzouki: bool, start: Start) -> Vec<Row> {
    let law = if merzouki { paper::merzouki_observed::<f64>(1e-3) } else { paper::pd() };
    run(&paper::hard_coulomb(4), start, &law, Ideal, regulate_to_zero, Timing::RECORDED)
}

fn mirrored(start: Start) -> Start {
    Start::at_rest(-start.load_position_rad, -start.motor_position_rad)
}

/// Largest imbalance between work, stored and dissipated energy along an open-loop run, as a fraction of the work turned
/// over. The work of a held torque and of dry friction is exact from positions; viscous losses by Simpson's rule.
fn energy_imbalance<P: TwoMass>(plant: &P, load_coulomb_nm: f64) -> f64 {
    let mechanics = Mechanics::paper();
    let dt_s = 1e-4;
    let trajectory = pushed(plant, dt_s, 40_000);
    let viscous_w = |truth: &Truth| {
        mechanics.load_friction_nm_s_rad * truth.load_velocity_rad_s.powi(2)
            + mechanics.motor_friction_nm_s_rad * truth.motor_velocity_rad_s.powi(2)
    };
    let (mut turned_over_j, mut supplied_j, mut worst_j) = (0.0_f64, 0.0_f64, 0.0_f64);
    for triple in trajectory.windows(3).step_by(2) {
        let [(start, torque_nm), (middle, _), (end, _)] = triple else { unreachable!("windows of three") };
        let work = torque_nm * (end.motor_position_rad - start.motor_position_rad);
        let viscous = dt_s / 3.0 * (viscous_w(start) + 4.0 * viscous_w(middle) + viscous_w(end));
        let dry = load_coulomb_nm
            * ((middle.load_position_rad - start.load_position_rad).abs()
                + (end.load_position_rad - middle.load_position_rad).abs());
        supplied_j += work - viscous - dry;
        turned_over_j += work.abs();
        worst_j = worst_j.max((end.energy_j() - trajectory[0].0.energy_j() - supplied_j).abs());
    }
    worst_j / turned_over_j
}

#[test]
fn energy_of_the_smooth_plant_balances() {
    let imbalance = energy_imbalance(&paper::smooth(4), 0.0);
    assert!(imbalance < 1e-9, "have {imbalance:e} of the work, want below 1e-9");
}

#[test]
fn energy_of_the_hard_gap_with_friction_balances() {
    let imbalance = energy_imbalance(&paper::hard_coulomb(4), paper::LOAD_COULOMB_NM);
    assert!(imbalance < 1e-7, "have {imbalance:e} of the work, want below 1e-7");
}

#[test]
fn contact_never_pulls_and_the_gap_carries_nothing() {
    let half_gap = Mechanics::paper().dead_zone_rad;
    let mut seen = [0_u32; 3];
    for (truth, _) in pushed(&paper::hard_coulomb(4), 1e-3, 8_000) {
        seen[(truth.contact.sign() + 1.0) as usize] += 1;
        match truth.contact {
            Contact::Gap => assert_eq!(truth.transmitted_torque_nm, 0.0),
            side => assert!(side.sign() * truth.transmitted_torque_nm >= 0.0, "{truth:?}"),
        }
        assert!(truth.gap_position_rad.abs() <= half_gap + 1e-12, "{truth:?}");
    }
    assert!(seen.iter().all(|&rows| rows > 100), "both flanks and the gap occur: {seen:?}");
}

#[test]
fn smooth_dead_zone_has_neither_torque_nor_slope_at_zero() {
    // (5): C = K (z - 4 j0 tanh(z / 4 j0)) = K z^3 / (3 (4 j0)^2) + O(z^5).
    let plant = paper::smooth(4);
    let transmitted = |twist_rad: f64| {
        let start = Start::at_rest(0.0, twist_rad);
        plant.truth(&plant.initial_state(start)).transmitted_torque_nm
    };
    assert_eq!(transmitted(0.0), 0.0);
    for twist_rad in [1e-3, -1e-3, 1e-2] {
        let (have, want) = (transmitted(twist_rad), twist_rad.powi(3) / (3.0 * 0.64 * 0.64));
        assert!((have / want - 1.0).abs() < 1e-3, "z = {twist_rad}: have {have:e}, want {want:e} N m");
    }
}

#[test]
fn pd_stops_at_the_static_error_of_the_closed_form() {
    // At rest U = C = -F_c / N0 and z = C / K - j0; (16) then gives 13 e_s = 3 F_c / N0 + 2 j0.
    let want = (3.0 * paper::LOAD_COULOMB_NM / 3.0 + 2.0 * 0.16) / 13.0;
    let rows = hard_coulomb_rows(false, paper::START);
    let have = rows.last().expect("rows").truth.load_position_rad;
    // The load creeps to the point where friction holds it; after 25 s half a microradian remains.
    assert!((have - want).abs() < 1e-6, "have {have}, want {want} rad");
    assert!((want - 0.32).abs() < 1e-12);
}

#[test]
fn sticking_load_has_exactly_zero_velocity() {
    let rows = pushed(&paper::hard_coulomb(4), 1e-3, 8_000);
    let (stuck, moving): (Vec<_>, Vec<_>) =
        rows.iter().partition(|(truth, _)| truth.load_friction == DryFriction::Stick);
    assert!(stuck.len() > 100 && moving.len() > 100, "{} stuck, {} moving", stuck.len(), moving.len());
    assert!(stuck.iter().all(|(truth, _)| truth.load_velocity_rad_s == 0.0));
    // Friction balances the spring, up to its limit.
    let held = |truth: &Truth| 3.0 * truth.transmitted_torque_nm.abs() <= paper::LOAD_COULOMB_NM;
    assert!(stuck.iter().all(|(truth, _)| held(truth)));
}

#[test]
fn mirrored_start_gives_the_mirrored_trajectory() {
    for merzouki in [false, true] {
        let rows = hard_coulomb_rows(merzouki, paper::START);
        for (row, mirror) in rows.iter().zip(hard_coulomb_rows(merzouki, mirrored(paper::START))) {
            assert_eq!(row.truth.load_position_rad, -mirror.truth.load_position_rad, "at {} s", row.time_s);
            assert_eq!(row.truth.motor_position_rad, -mirror.truth.motor_position_rad, "at {} s", row.time_s);
            assert_eq!(row.torque_nm, -mirror.torque_nm, "at {} s", row.time_s);
            assert_eq!(row.dead_zone_estimate_rad, mirror.dead_zone_estimate_rad, "at {} s", row.time_s);
        }
    }
}

#[test]
fn compensation_removes_lost_motion_under_a_slow_sine() {
    let [before, after] = [paper::pd::<f64>(), paper::merzouki_observed(1e-3)].map(|law| {
        let timing = Timing { periods: 80_000, ..Timing::RECORDED };
        lost_motion_rad(&run(
            &paper::hard_coulomb(4),
            Start::at_rest(0.0, 0.0),
            &law,
            Ideal,
            slow_sine,
            timing,
        ))
    });
    assert!((0.30..0.35).contains(&before), "before: have {before} rad");
    assert!(after < 0.02, "after: have {after} rad");
}
