//! Row by row against the recorded trajectories, over 25 s.
//!
//! The bounds are the recorded programs' own stated errors, 1e-10 rad at the load and 7e-8 rad at the motor, and what
//! follows from the latter for velocity (the motor rings at 55 rad/s) and torque.

use crate::closed_loop::{Ideal, Row, Timing, regulate_to_nought, run};
use crate::paper;
use crate::recorded::{Difference, difference, read};

const STATED: Difference = Difference {
    load_position_rad: 1e-10,
    load_velocity_rad_s: 1e-9,
    motor_position_rad: 7e-8,
    motor_velocity_rad_s: 4e-6,
    torque_nm: 2e-7,
    dead_zone_estimate_rad: 1e-9,
};

#[track_caller]
fn assert_within(have: Difference, bound: Difference) {
    let pairs = [
        ("load position, rad", have.load_position_rad, bound.load_position_rad),
        ("load velocity, rad/s", have.load_velocity_rad_s, bound.load_velocity_rad_s),
        ("motor position, rad", have.motor_position_rad, bound.motor_position_rad),
        ("motor velocity, rad/s", have.motor_velocity_rad_s, bound.motor_velocity_rad_s),
        ("torque, N m", have.torque_nm, bound.torque_nm),
        ("dead-zone estimate, rad", have.dead_zone_estimate_rad, bound.dead_zone_estimate_rad),
    ];
    for (what, have, bound) in pairs {
        assert!(have <= bound, "{what}: differs by {have:e}, allowed {bound:e}");
    }
}

#[test]
fn held_pd_on_the_smooth_plant_agrees() {
    let rows = run::<f64, _>(
        &paper::smooth(4),
        paper::START,
        &paper::pd(),
        Ideal,
        regulate_to_nought,
        Timing::RECORDED,
    );
    assert_within(difference(&rows, &read("zoh_smooth_pd"), 10), STATED);
}

#[test]
fn held_merzouki_on_the_smooth_plant_agrees() {
    let law = paper::merzouki_nominal::<f64>(1e-3);
    let rows = run(&paper::smooth(4), paper::START, &law, Ideal, regulate_to_nought, Timing::RECORDED);
    assert_within(difference(&rows, &read("zoh_smooth_merzouki"), 10), STATED);
}

#[test]
fn held_pd_on_the_hard_gap_with_friction_agrees() {
    let law = paper::pd::<f64>();
    let rows = run(&paper::hard_coulomb(4), paper::START, &law, Ideal, regulate_to_nought, Timing::RECORDED);
    assert_within(difference(&rows, &read("zoh_hardcoul_pd"), 10), STATED);
}

#[test]
fn held_merzouki_on_the_hard_gap_with_friction_agrees() {
    let law = paper::merzouki_observed::<f64>(1e-3);
    let rows = run(&paper::hard_coulomb(4), paper::START, &law, Ideal, regulate_to_nought, Timing::RECORDED);
    assert_within(difference(&rows, &read("zoh_hardcoul_merzouki"), 10), STATED);
}

#[test]
fn held_pd_on_the_bench_agrees() {
    let law = paper::pd::<f64>();
    let recorded = read("zoh_bench_pd");
    let with = |substeps| {
        let plant = paper::bench(substeps);
        let rows = run(&plant, paper::START, &law, Ideal, regulate_to_nought, Timing::RECORDED);
        difference(&rows, &recorded, 10)
    };
    assert_within(with(64), STATED);
    // The substeps of the scenarios leave an error of their own: the motor crosses its Stribeck velocity in 10 us.
    let default = Difference {
        load_position_rad: 1e-9,
        load_velocity_rad_s: 1e-8,
        motor_position_rad: 1e-6,
        motor_velocity_rad_s: 6e-5,
        torque_nm: 2e-6,
        ..STATED
    };
    assert_within(with(16), default);
}

/// A loop at `rate` times 1 kHz, one Runge-Kutta step per period, as rows every 10 ms.
fn smooth_at_rate(rate: usize, merzouki: bool) -> Vec<Row> {
    let period_s = 1e-3 / rate as f64;
    let law = if merzouki { paper::merzouki_nominal::<f64>(period_s) } else { paper::pd() };
    let timing = Timing { period_s, periods: 25_000 * rate, ..Timing::RECORDED };
    let rows = run(&paper::smooth(1), paper::START, &law, Ideal, regulate_to_nought, timing);
    rows.into_iter().step_by(10 * rate).collect()
}

/// The limit of a vanishing period, from two periods: a held torque is late by half a period on the average, an error of
/// first order, which cancels in 2 x(T/2) - x(T).
fn extrapolated(coarse: &[Row], fine: &[Row]) -> Vec<Row> {
    let limit = |coarse: f64, fine: f64| 2.0 * fine - coarse;
    let rows = coarse.iter().zip(fine).map(|(c, f)| {
        let mut row = *f;
        row.truth.load_position_rad = limit(c.truth.load_position_rad, f.truth.load_position_rad);
        row.truth.load_velocity_rad_s = limit(c.truth.load_velocity_rad_s, f.truth.load_velocity_rad_s);
        row.truth.motor_position_rad = limit(c.truth.motor_position_rad, f.truth.motor_position_rad);
        row.truth.motor_velocity_rad_s = limit(c.truth.motor_velocity_rad_s, f.truth.motor_velocity_rad_s);
        row.torque_nm = limit(c.torque_nm, f.torque_nm);
        row.dead_zone_estimate_rad = limit(c.dead_zone_estimate_rad, f.dead_zone_estimate_rad);
        row
    });
    rows.collect()
}

#[test]
fn shrinking_the_period_leads_to_continuous_control() {
    for (merzouki, name) in [(false, "cont_smooth_pd"), (true, "cont_smooth_merzouki")] {
        let recorded = read(name);
        let rows @ [_, medium, fast] = &[8, 16, 32].map(|rate| smooth_at_rate(rate, merzouki));
        let motor = |rows: &[Row]| difference(rows, &recorded, 1).motor_position_rad;
        let [at_8_khz, at_16_khz, at_32_khz] = rows.each_ref().map(|rows| motor(rows));
        for ratio in [at_8_khz / at_16_khz, at_16_khz / at_32_khz] {
            assert!(
                (1.95..2.05).contains(&ratio),
                "{name}: half the period leaves 1/{ratio} of the difference"
            );
        }
        // What is left is of second order in 1/32 ms: with 55 rad/s of ringing behind 190 rad/s, some 1e-4 rad.
        let limit = difference(&extrapolated(medium, fast), &recorded, 1);
        assert!(limit.load_position_rad < 2e-7, "{name}: load differs by {:e} rad", limit.load_position_rad);
        assert!(
            limit.motor_position_rad < 2e-4,
            "{name}: motor differs by {:e} rad",
            limit.motor_position_rad
        );
        assert!(limit.dead_zone_estimate_rad < 2e-6, "{name}: {:e} rad", limit.dead_zone_estimate_rad);
        assert!(at_32_khz / limit.motor_position_rad > 50.0, "{name}: extrapolation is worth its while");
    }
}
