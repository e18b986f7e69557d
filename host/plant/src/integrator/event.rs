//! Event location: the instant within a substep at which a mode ends.
//!
//! The unknown is the step *length*: each trial of the Illinois variant of false position is one step from the same start.

use super::hybrid::HybridSystem;

/// Trials for one event. Illinois needs about eight; the bound is for a guard function without a slope.
const MAX_TRIALS: u32 = 100;

/// Width of the bracket, as a fraction of the substep, at which an event counts as located.
const BRACKET_FRACTION: f64 = 1e-13;

/// The first instant of a mode that begins on its edge, as a fraction of the substep: long enough for time to advance,
/// short enough to leave no trace in the trajectory.
const FIRST_INSTANT_FRACTION: f64 = 1e-9;

/// Step length just past the zero of a guard function that is negative after `limit_s`. We return the far side of the
/// bracket so that the next mode holds from its first instant.
pub(super) fn locate<S: HybridSystem>(
    system: &S,
    guard: S::Guard,
    x: &S::State,
    mode: S::Mode,
    torque_nm: f64,
    limit_s: f64,
) -> f64 {
    let value = |h_s: f64| {
        let end = system.flow(x, mode, torque_nm, system.stride(h_s));
        system.guard(guard, &end, mode)
    };
    let (mut near, mut far) = (0.0, limit_s);
    let (mut near_value, mut far_value) = (value(near), value(far));
    if near_value <= 0.0 {
        // The mode begins on its own edge: a load that breaks away from rest, or rounding at a contact. Either the state
        // leaves the edge and returns later, or the mode ends at once.
        near = FIRST_INSTANT_FRACTION * limit_s;
        near_value = value(near);
        if near_value <= 0.0 {
            return near;
        }
    }
    let mut last_kept = End::Neither;
    for _ in 0..MAX_TRIALS {
        if far - near <= BRACKET_FRACTION * limit_s {
            break;
        }
        let trial = far - far_value * (far - near) / (far_value - near_value);
        let trial = if trial > near && trial < far { trial } else { 0.5 * (near + far) };
        let trial_value = value(trial);
        if trial_value == 0.0 {
            return trial;
        }
        // Illinois: the value at an end that stays twice in a row is halved, so that the end can't stay for good.
        if trial_value < 0.0 {
            (far, far_value) = (trial, trial_value);
            if last_kept == End::Near {
                near_value *= 0.5;
            }
            last_kept = End::Near;
        } else {
            (near, near_value) = (trial, trial_value);
            if last_kept == End::Far {
                far_value *= 0.5;
            }
            last_kept = End::Far;
        }
    }
    far
}

/// The end of the bracket that the last trial left in place.
#[derive(Clone, Copy, PartialEq)]
enum End {
    Neither,
    Near,
    Far,
}
