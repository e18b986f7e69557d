//! A plant under an alternating open-loop torque.

use lashloop_plant::{Start, Truth, TwoMass};

/// Seconds for which a push is held before it reverses.
const PUSH_S: f64 = 0.4;

/// 4 N m forwards and 3 N m backwards: the motor crosses the gap, and the load breaks away and sticks again.
pub(crate) fn push_nm(time_s: f64) -> f64 {
    if ((time_s / PUSH_S) as u64).is_multiple_of(2) { 4.0 } else { -3.0 }
}

/// The truth at every step of `dt_s`, from rest in the middle of the gap; `dt_s` divides [`PUSH_S`].
pub(crate) fn pushed<P: TwoMass>(plant: &P, dt_s: f64, steps: usize) -> Vec<(Truth, f64)> {
    let mut state = plant.initial_state(Start::at_rest(0.0, 0.0));
    let mut trajectory = Vec::with_capacity(steps + 1);
    for k in 0..=steps {
        // In the middle of the step, where rounding can't select the other direction.
        let torque_nm = push_nm((k as f64 + 0.5) * dt_s);
        trajectory.push((plant.truth(&state), torque_nm));
        plant.step(&mut state, torque_nm, dt_s).expect("the plant steps");
    }
    trajectory
}
