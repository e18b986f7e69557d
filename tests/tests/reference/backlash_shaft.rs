//! Physical laws on the backlash shaft.

use core::f64::consts::TAU;

use lashloop_plant::backlash_shaft::{BacklashShaft, ShaftParameters, StribeckParameters};
use lashloop_plant::hard_coulomb::HardCoulomb;
use lashloop_plant::{Contact, DryFriction, Mechanics, Start, Truth, TwoMass};

use crate::closed_loop::{Ideal, Timing, regulate_to_zero, run};
use crate::open_loop::{push_nm, pushed};
use crate::paper;
use crate::trajectory::Row;

/// Largest imbalance of the recorded energies, as a fraction of the energy supplied and taken back.
pub(crate) fn recorded_imbalance(truths: &[Truth]) -> f64 {
    let first = truths[0];
    let turned_over_j: f64 =
        truths.windows(2).map(|pair| (pair[1].supplied_energy_j - pair[0].supplied_energy_j).abs()).sum();
    let imbalance_j = |truth: &Truth| {
        let supplied_j = truth.supplied_energy_j - first.supplied_energy_j;
        let dissipated_j = truth.dissipated_energy_j - first.dissipated_energy_j;
        (truth.energy_j() - first.energy_j() - supplied_j + dissipated_j).abs()
    };
    truths.iter().map(imbalance_j).fold(0.0, f64::max) / turned_over_j
}

pub(crate) fn truths<P: TwoMass>(plant: &P, dt_s: f64, steps: usize) -> Vec<Truth> {
    pushed(plant, dt_s, steps).into_iter().map(|(truth, _)| truth).collect()
}

fn pd_rows(plant: &BacklashShaft, start: Start) -> Vec<Row> {
    run(plant, start, &paper::pd::<f64>(), Ideal, regulate_to_zero, Timing::RECORDED)
}

fn pd_truths() -> Vec<Truth> {
    pd_rows(&paper::backlash_shaft(16), paper::START).iter().map(|row| row.truth).collect()
}

/// No lag, no dry friction on the motor, stiction equal to Coulomb friction.
fn plain() -> ShaftParameters {
    let coulomb =
        |coulomb_nm| StribeckParameters { coulomb_nm, stiction_nm: coulomb_nm, velocity_rad_s: 1.0 };
    ShaftParameters {
        load: coulomb(paper::LOAD_COULOMB_NM),
        motor: coulomb(0.0),
        current_lag_s: 0.0,
        ..paper::unlimited()
    }
}

#[test]
fn recorded_energy_balances() {
    for (name, truths, bound) in [
        ("smooth", truths(&paper::smooth(4), 1e-3, 8_000), 1e-11),
        ("hard-coulomb", truths(&paper::hard_coulomb(4), 1e-3, 8_000), 1e-11),
        ("backlash shaft", truths(&paper::backlash_shaft(16), 1e-3, 8_000), 3e-11),
        ("backlash shaft under a law", pd_truths(), 1e-8),
        ("backlash shaft, finely", truths(&paper::backlash_shaft(64), 1e-3, 8_000), 1e-13),
    ] {
        let imbalance = recorded_imbalance(&truths);
        assert!(imbalance < bound, "{name}: have {imbalance:e} of the work, want below {bound:e}");
        let last = truths.last().expect("truths");
        assert!(last.dissipated_energy_j > 1.0, "{name}: dissipates energy: {last:?}");
    }
}

#[test]
fn energy_supplied_is_the_work_of_the_held_torque() {
    // Without lag the torque at the motor is the commanded one, and its work is exact from positions.
    for truths in [
        truths(&paper::backlash_shaft_with(plain(), 16), 1e-3, 8_000),
        truths(&paper::hard_coulomb(4), 1e-3, 8_000),
    ] {
        let work = |(k, pair): (usize, &[Truth])| {
            push_nm((k as f64 + 0.5) * 1e-3) * (pair[1].motor_position_rad - pair[0].motor_position_rad)
        };
        let want: f64 = truths.windows(2).enumerate().map(work).sum();
        let have = truths.last().expect("truths").supplied_energy_j;
        assert!((have / want - 1.0).abs() < 1e-7, "have {have} J, want {want} J");
    }
}

#[test]
fn friction_and_damping_never_supply_energy() {
    for truths in
        [truths(&paper::backlash_shaft(16), 1e-3, 8_000), truths(&paper::hard_coulomb(4), 1e-3, 8_000)]
    {
        for pair in truths.windows(2) {
            assert!(pair[1].dissipated_energy_j >= pair[0].dissipated_energy_j, "{pair:?}");
        }
    }
}

#[test]
fn contact_never_pulls_and_the_gap_carries_nothing() {
    let mut seen = [0_u32; 3];
    for truth in truths(&paper::backlash_shaft(16), 1e-3, 8_000) {
        let side = truth.contact.sign();
        seen[(side + 1.0) as usize] += 1;
        assert!(truth.gap_position_rad.abs() <= truth.dead_zone_rad + 1e-12, "{truth:?}");
        match truth.contact {
            Contact::Gap => assert_eq!(truth.transmitted_torque_nm, 0.0),
            _ => {
                assert!(side * truth.transmitted_torque_nm >= -1e-12, "{truth:?}");
                assert_eq!(truth.gap_position_rad, side * truth.dead_zone_rad);
            }
        }
    }
    assert!(seen.iter().all(|&rows| rows > 100), "both flanks and the gap occur: {seen:?}");
}

/// Largest distance between motor positions in rad.
fn motor_distance_rad(one: &[Truth], other: &[Truth]) -> f64 {
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| (a.motor_position_rad - b.motor_position_rad).abs()).fold(0.0, f64::max)
}

#[test]
fn without_damping_the_backlash_shaft_is_the_hard_gap() {
    let undamped = ShaftParameters { shaft_damping_nm_s_rad: 0.0, ..plain() };
    let shaft = truths(&paper::backlash_shaft_with(undamped, 16), 1e-3, 8_000);
    let hard = HardCoulomb::new(Mechanics::paper(), paper::LOAD_COULOMB_NM, 16).expect("valid plant");
    let distance_rad = motor_distance_rad(&shaft, &truths(&hard, 1e-3, 8_000));
    assert!(distance_rad < 1e-9, "have {distance_rad:e} rad");
}

#[test]
fn distance_to_the_hard_gap_is_proportional_to_damping() {
    let with = |shaft_damping_nm_s_rad| {
        let parameters = ShaftParameters { shaft_damping_nm_s_rad, ..plain() };
        // Only up to the first sticking: its instant is not continuous in the damping.
        truths(&paper::backlash_shaft_with(parameters, 16), 1e-3, 700)
    };
    let hard = with(0.0);
    let distances = [3.1e-5, 3.1e-6, 3.1e-7, 3.1e-8].map(|damping| motor_distance_rad(&with(damping), &hard));
    for pair in distances.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((9.0..11.0).contains(&ratio), "a tenth of the damping leaves 1/{ratio}: {distances:?} rad");
    }
}

#[test]
fn pd_stops_at_the_static_error_of_the_closed_form() {
    // While they creep, load and motor carry their stiction: 3 C = -F_s, U = C - F_sM, z = C / K - j0; the cascade has
    // U = -2 K z - 13 K theta_s.
    let last = *pd_truths().last().expect("truths");
    let parameters = ShaftParameters::paper();
    let want = (3.0 * parameters.load.stiction_nm / 3.0 + 2.0 * 0.16 + parameters.motor.stiction_nm) / 13.0;
    let have = last.load_position_rad;
    assert!((have - want).abs() < 1e-6, "have {have}, want {want} rad");
    assert!((want - 0.3204).abs() < 5e-5);
}

#[test]
fn mirrored_start_gives_the_mirrored_trajectory() {
    let mirror = Start::at_rest(-paper::START.load_position_rad, -paper::START.motor_position_rad);
    let plant = paper::backlash_shaft(16);
    for (row, mirrored) in pd_rows(&plant, paper::START).iter().zip(pd_rows(&plant, mirror)) {
        assert_eq!(row.truth.load_position_rad, -mirrored.truth.load_position_rad, "at {} s", row.time_s);
        assert_eq!(row.truth.motor_position_rad, -mirrored.truth.motor_position_rad, "at {} s", row.time_s);
        assert_eq!(row.truth.gap_position_rad, -mirrored.truth.gap_position_rad, "at {} s", row.time_s);
    }
}

#[test]
fn sticking_mass_is_held_by_friction_within_its_limit() {
    let limits = ShaftParameters::paper();
    let plant = paper::backlash_shaft(16);
    let mut state = plant.initial_state(Start::at_rest(0.0, 0.0));
    let (mut stuck, mut released) = ([0_u32; 2], [0_u32; 2]);
    for k in 0..20_000 {
        // Slowly enough for the masses to stop at both ends.
        plant.step(&mut state, 2.0 * (0.1 * TAU * f64::from(k) * 1e-3).sin(), 1e-3).expect("the plant steps");
        let truth = plant.truth(&state);
        released[0] += u32::from(truth.load_velocity_rad_s != 0.0);
        released[1] += u32::from(truth.motor_velocity_rad_s != 0.0);
        if truth.load_friction == DryFriction::Stick {
            stuck[0] += 1;
            assert_eq!(truth.load_velocity_rad_s, 0.0);
            assert_eq!(truth.load_dry_friction_nm, 3.0 * truth.transmitted_torque_nm);
            assert!(truth.load_dry_friction_nm.abs() <= limits.load.stiction_nm, "{truth:?}");
        }
        if truth.motor_friction == DryFriction::Stick {
            stuck[1] += 1;
            assert_eq!(truth.motor_velocity_rad_s, 0.0);
            assert!(truth.motor_dry_friction_nm.abs() <= limits.motor.stiction_nm, "{truth:?}");
        }
    }
    assert!(
        stuck.iter().chain(&released).all(|&rows| rows > 10),
        "both stick and slip: {stuck:?} {released:?}"
    );
}
