//! The order of the integrator, with and without located events.

use lashloop_plant::{Mechanics, PlantError, Start, Truth, TwoMass};

use crate::closed_loop::{Ideal, Timing, regulate_to_zero, run};
use crate::paper;

/// 8 s from the paper's start: the fast approach, the load breaking away and, with a hard gap, its crossing.
const TIMING: Timing = Timing { periods: 8_000, ..Timing::RECORDED };

/// Largest error of the motor position against a run with 64 substeps of the plant's own method.
fn errors<P: TwoMass, const N: usize>(
    plant: impl Fn(u32) -> P,
    best: &impl TwoMass,
    substeps: [u32; N],
) -> [f64; N] {
    fn motor<P: TwoMass>(plant: &P) -> Vec<f64> {
        let rows = run::<f64, _>(plant, paper::START, &paper::pd(), Ideal, regulate_to_zero, TIMING);
        rows.iter().map(|row| row.truth.motor_position_rad).collect()
    }
    let best = motor(best);
    substeps.map(|substeps| {
        let pairs = motor(&plant(substeps)).into_iter().zip(&best).map(|(have, want)| (have - want).abs());
        pairs.fold(0.0, f64::max)
    })
}

/// Order between the coarsest and the finest of errors at substeps 1, 2, 4.
fn order([coarse, _, fine]: [f64; 3]) -> f64 {
    (coarse / fine).log2() / 2.0
}

/// The hard gap with friction without located events: semi-implicit Euler, with contact and friction as they are at the
/// beginning of each substep.
struct WithoutEvents {
    substeps: u32,
}

impl TwoMass for WithoutEvents {
    type State = [f64; 4];

    fn initial_state(&self, start: Start) -> [f64; 4] {
        [start.load_position_rad, 0.0, start.motor_position_rad, 0.0]
    }

    fn step(&self, state: &mut [f64; 4], torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        let m = Mechanics::paper();
        let h = dt_s / f64::from(self.substeps);
        for _ in 0..self.substeps {
            let [load, load_velocity, motor, motor_velocity] = *state;
            let twist = motor - m.ratio * load;
            let transmitted = m.stiffness_nm_rad * (twist - twist.clamp(-m.dead_zone_rad, m.dead_zone_rad));
            let drive = m.ratio * transmitted;
            let against = if load_velocity == 0.0 { drive } else { load_velocity };
            let dry = paper::LOAD_COULOMB_NM.copysign(against);
            let moved = load_velocity
                + h * (drive - m.load_friction_nm_s_rad * load_velocity - dry) / m.load_inertia_kg_m2;
            let stops = load_velocity * moved < 0.0 || (load_velocity == 0.0 && drive.abs() <= dry.abs());
            let load_velocity = if stops { 0.0 } else { moved };
            let motor_torque = torque_nm - transmitted - m.motor_friction_nm_s_rad * motor_velocity;
            let motor_velocity = motor_velocity + h * motor_torque / m.motor_inertia_kg_m2;
            *state = [load + h * load_velocity, load_velocity, motor + h * motor_velocity, motor_velocity];
        }
        Ok(())
    }

    fn truth(&self, state: &[f64; 4]) -> Truth {
        let plant = paper::hard_coulomb(1);
        let start = Start::at_rest(state[0], state[2]);
        let truth = plant.truth(&plant.initial_state(start));
        Truth { load_velocity_rad_s: state[1], motor_velocity_rad_s: state[3], ..truth }
    }
}

#[test]
fn smooth_plant_converges_with_fourth_order() {
    let errors = errors(paper::smooth, &paper::smooth(64), [1, 2, 4]);
    let order = order(errors);
    assert!((3.8..4.2).contains(&order), "order {order} from errors {errors:?} rad");
}

#[test]
fn located_events_keep_the_order_across_mode_changes() {
    let errors = errors(paper::hard_coulomb, &paper::hard_coulomb(64), [1, 2, 4]);
    let order = order(errors);
    assert!(order > 3.5, "order {order} from errors {errors:?} rad");
}

/// Asserts that the largest errors in rad at load and motor over 25 s, with 1, 4 and 16 substeps, lie below the bounds, but
/// not far below.
fn assert_errors<P: TwoMass>(plant: impl Fn(u32) -> P, bounds_rad: [[f64; 2]; 3]) {
    let rows = |substeps| {
        let law = paper::pd::<f64>();
        run(&plant(substeps), paper::START, &law, Ideal, regulate_to_zero, Timing::RECORDED)
    };
    let best = rows(256);
    for (substeps, bounds_rad) in [1, 4, 16].into_iter().zip(bounds_rad) {
        let rows = rows(substeps);
        let worst = |of: fn(&Truth) -> f64| {
            let pairs = rows.iter().zip(&best).map(|(a, b)| (of(&a.truth) - of(&b.truth)).abs());
            pairs.fold(0.0, f64::max)
        };
        let have_rad = [worst(|truth| truth.load_position_rad), worst(|truth| truth.motor_position_rad)];
        for (have, bound) in have_rad.into_iter().zip(bounds_rad) {
            assert!(
                have < bound && have > bound / 30.0,
                "{substeps} substeps: {have_rad:?}, bounds {bounds_rad:?}"
            );
        }
    }
}

// Bounds are three times the errors of an independent program with the same method.

#[test]
fn substeps_of_the_smooth_plant_leave_the_documented_error() {
    assert_errors(paper::smooth, [[2.4e-9, 1.2e-6], [9e-12, 6e-9], [1.2e-13, 1.8e-11]]);
}

#[test]
fn substeps_of_the_hard_gap_leave_the_documented_error() {
    assert_errors(paper::hard_coulomb, [[6e-10, 9e-7], [2.1e-12, 3e-9], [1.2e-13, 1.2e-11]]);
}

#[test]
fn substeps_of_the_backlash_shaft_leave_the_documented_error() {
    assert_errors(paper::backlash_shaft, [[2.1e-6, 2.4e-3], [2.7e-8, 9e-6], [1.5e-9, 9e-7]]);
}

#[test]
fn without_located_events_the_order_is_one() {
    let located = errors(paper::hard_coulomb, &paper::hard_coulomb(64), [4]);
    let errors = errors(|substeps| WithoutEvents { substeps }, &paper::hard_coulomb(64), [4, 8, 16]);
    let order = order(errors);
    assert!((0.7..1.3).contains(&order), "order {order} from errors {errors:?} rad");
    assert!(errors[0] > 1e6 * located[0], "have {} rad without, {} rad with events", errors[0], located[0]);
}
