//! A plant pushed back and forth by a torque that knows nothing of it.

use lashloop_plant::{Plant, Start, Truth};

/// Seconds for which a push is held before it turns round.
const PUSH_S: f64 = 0.4;

/// A push of 4 N m one way and 3 N m the other: it crosses the gap, breaks the load away, lets it stick again.
pub(crate) fn push_nm(time_s: f64) -> f64 {
    if ((time_s / PUSH_S) as u64).is_multiple_of(2) { 4.0 } else { -3.0 }
}

/// The truth at every step of `dt_s`, from rest in the middle of the gap; `dt_s` divides [`PUSH_S`].
pub(crate) fn pushed<P: Plant>(plant: &P, dt_s: f64, steps: usize) -> Vec<(Truth, f64)> {
    let mut state = plant.initial_state(Start::at_rest(0.0, 0.0));
    let mut trajectory = Vec::with_capacity(steps + 1);
    for k in 0..=steps {
        // In the middle of the step, where rounding can't turn the push round.
        let torque_nm = push_nm((k as f64 + 0.5) * dt_s);
        trajectory.push((plant.truth(&state), torque_nm));
        plant.step(&mut state, torque_nm, dt_s).expect("the plant steps");
    }
    trajectory
}
