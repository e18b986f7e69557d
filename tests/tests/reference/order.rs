//! The order of the integrator, and what locating events is worth.

use lashloop::plant::{Mechanics, Plant, PlantError, Start, Truth};

use crate::closed_loop::{Ideal, Timing, regulate_to_nought, run};
use crate::paper;

/// 8 s of the paper's start: the fast approach, breaking away and, on the hard gap, crossing it.
const TIMING: Timing = Timing { periods: 8_000, ..Timing::RECORDED };

/// Largest error of the motor position against a run with 64 substeps of the plant's own method.
fn errors<P: Plant, const N: usize>(
    plant: impl Fn(u32) -> P,
    best: &impl Plant,
    substeps: [u32; N],
) -> [f64; N] {
    fn motor<P: Plant>(plant: &P) -> Vec<f64> {
        let rows = run::<f64, _, _>(plant, paper::START, &paper::pd(), Ideal, regulate_to_nought, TIMING);
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

/// The hard gap with friction without any event: semi-implicit Euler, contact and friction taken as they are at the
/// beginning of each step.
struct WithoutEvents {
    substeps: u32,
}

impl Plant for WithoutEvents {
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
fn smooth_plant_converges_with_the_fourth_order() {
    let errors = errors(paper::smooth, &paper::smooth(64), [1, 2, 4]);
    let order = order(errors);
    assert!((3.8..4.2).contains(&order), "order {order} from errors {errors:?} rad");
}

#[test]
fn located_events_keep_the_order_across_contact_and_friction() {
    let errors = errors(paper::hard_coulomb, &paper::hard_coulomb(64), [1, 2, 4]);
    let order = order(errors);
    assert!(order > 3.5, "order {order} from errors {errors:?} rad");
}

#[test]
fn substeps_of_the_bench_buy_what_they_are_said_to() {
    let bench = |substeps| {
        let plant = paper::bench(substeps);
        run::<f64, _, _>(&plant, paper::START, &paper::pd(), Ideal, regulate_to_nought, Timing::RECORDED)
    };
    let best = bench(256);
    // Largest errors over 25 s at the load and at the motor in rad. An independent program of the same kind has 7e-7 and
    // 8e-4, 9e-9 and 3e-6, 5e-10 and 3e-7.
    for (substeps, load_rad, motor_rad) in [(1, 7e-7, 2e-3), (4, 9e-9, 9e-6), (16, 5e-10, 5e-7)] {
        let rows = bench(substeps);
        let worst = |of: fn(&Truth) -> f64| {
            let pairs = rows.iter().zip(&best).map(|(a, b)| (of(&a.truth) - of(&b.truth)).abs());
            pairs.fold(0.0, f64::max)
        };
        let have = (worst(|truth| truth.load_position_rad), worst(|truth| truth.motor_position_rad));
        assert!(have.0 < load_rad && have.1 < motor_rad, "{substeps} substeps leave {have:?} rad");
        // And not so little that nothing was compared.
        assert!(
            have.0 > load_rad / 30.0 && have.1 > motor_rad / 30.0,
            "{substeps} substeps leave {have:?} rad"
        );
    }
}

#[test]
fn without_events_the_order_is_one_and_the_error_a_million_times_larger() {
    let located = errors(paper::hard_coulomb, &paper::hard_coulomb(64), [4]);
    let errors = errors(|substeps| WithoutEvents { substeps }, &paper::hard_coulomb(64), [4, 8, 16]);
    let order = order(errors);
    assert!((0.7..1.3).contains(&order), "order {order} from errors {errors:?} rad");
    assert!(errors[0] > 1e6 * located[0], "have {} rad without, {} rad with events", errors[0], located[0]);
}
