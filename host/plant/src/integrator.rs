//! Fixed-step integration of a system that switches between smooth modes.
//!
//! Within a mode (this side in contact, the load sticking) the right-hand side is smooth and Runge-Kutta of fourth
//! order keeps its order. A step across a switch would not: its error is of first order in the step, however good the
//! method. So after each substep the mode functions are tested; if one has changed sign, the step *length* at which
//! it is nought is found (Illinois variant of false position, each trial one Runge-Kutta step from the same start), the
//! earliest switch is taken, and the rest of the substep goes on in the new mode.
//!
//! Two changes within one substep that cancel each other are not seen; the substep has to be short against the fastest
//! motion of the plant.
//!
//! A system brings its own step, [`HybridSystem::flow`], so that what has a closed form (a lag, a spring that relaxes) is
//! taken from it; [`runge_kutta`] is there for the rest.

use nalgebra::SVector;

use crate::PlantError;

/// Switches in one substep beyond which a plant is said to chatter.
pub const MAX_EVENTS: u32 = 64;

/// Trials for one switch. Illinois takes about eight; the bound is for a mode function without a slope.
const MAX_TRIALS: u32 = 100;

/// Width of the bracket, as a share of the substep, at which a switch counts as located.
const BRACKET_SHARE: f64 = 1e-13;

/// The first instant of a mode that begins on its edge, as a share of the substep: long enough for time to go on, short
/// enough not to be seen.
const FIRST_INSTANT_SHARE: f64 = 1e-9;

/// A system that switches between smooth modes.
pub trait HybridSystem {
    /// Everything that moves.
    type State: Copy;

    /// The mode: which right-hand side holds.
    type Mode: Copy;

    /// A step length with everything that depends on it alone worked out.
    type Stride: Copy;

    /// Number of mode functions.
    const GUARDS: usize;

    /// A stride of `h_s` seconds.
    fn stride(&self, h_s: f64) -> Self::Stride;

    /// The state one stride later if `mode` holds as long, also valid a little beyond the end of the mode.
    fn flow(&self, x: &Self::State, mode: Self::Mode, torque_nm: f64, stride: Self::Stride) -> Self::State;

    /// Mode function number `guard`: not negative while `mode` holds, and smooth across its end.
    fn guard(&self, guard: usize, x: &Self::State, mode: Self::Mode, torque_nm: f64) -> f64;

    /// The mode that follows where mode function `guard` has reached nought; sets the coordinates that are known
    /// exactly there.
    fn switch(&self, guard: usize, x: &mut Self::State, mode: Self::Mode, torque_nm: f64) -> Self::Mode;

    /// The mode under a torque that has just changed; sets the coordinates that follow the torque at once.
    fn settle(&self, x: &mut Self::State, mode: Self::Mode, torque_nm: f64) -> Self::Mode;

    /// Whether every coordinate is a finite number.
    fn is_finite(&self, x: &Self::State) -> bool;
}

/// Where in a step of [`runge_kutta`] a right-hand side is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// At its beginning.
    Start,
    /// Half way, twice.
    Middle,
    /// At its end.
    End,
}

/// A right-hand side.
pub trait Rates<const N: usize> {
    /// Rates of change at `x`.
    fn at(&self, x: &SVector<f64, N>, stage: Stage) -> SVector<f64, N>;
}

impl<const N: usize, F: Fn(&SVector<f64, N>, Stage) -> SVector<f64, N>> Rates<N> for F {
    #[inline(always)]
    fn at(&self, x: &SVector<f64, N>, stage: Stage) -> SVector<f64, N> {
        self(x, stage)
    }
}

/// One step of the classical Runge-Kutta method. Inlined, so that rates no other rate depends on cost nothing between the
/// stages.
#[inline(always)]
pub fn runge_kutta<const N: usize>(x: &SVector<f64, N>, h_s: f64, rates: &impl Rates<N>) -> SVector<f64, N> {
    let k1 = rates.at(x, Stage::Start);
    let k2 = rates.at(&(x + k1 * (0.5 * h_s)), Stage::Middle);
    let k3 = rates.at(&(x + k2 * (0.5 * h_s)), Stage::Middle);
    let k4 = rates.at(&(x + k3 * h_s), Stage::End);
    x + (k1 + (k2 + k3) * 2.0 + k4) * (h_s / 6.0)
}

/// Holds the torque for `dt_s` seconds in `substeps` equal steps.
///
/// # Errors
/// See [`PlantError`].
pub fn advance<S: HybridSystem>(
    system: &S,
    x: &mut S::State,
    mode: &mut S::Mode,
    torque_nm: f64,
    dt_s: f64,
    substeps: u32,
) -> Result<(), PlantError> {
    if !torque_nm.is_finite() {
        return Err(PlantError::Torque { torque_nm });
    }
    if !(dt_s >= 0.0 && dt_s.is_finite()) {
        return Err(PlantError::Duration { dt_s });
    }
    let substep_s = dt_s / f64::from(substeps);
    *mode = system.settle(x, *mode, torque_nm);
    let stride = system.stride(substep_s);
    for _ in 0..substeps {
        let end = system.flow(x, *mode, torque_nm, stride);
        if (0..S::GUARDS).all(|guard| system.guard(guard, &end, *mode, torque_nm) >= 0.0) {
            *x = end;
        } else {
            substep_with_events(system, x, mode, torque_nm, substep_s)?;
        }
    }
    if system.is_finite(x) { Ok(()) } else { Err(PlantError::NotFinite { torque_nm }) }
}

/// A substep in which a mode ends. Kept apart, so that the common step stays short.
#[cold]
#[inline(never)]
fn substep_with_events<S: HybridSystem>(
    system: &S,
    x: &mut S::State,
    mode: &mut S::Mode,
    torque_nm: f64,
    substep_s: f64,
) -> Result<(), PlantError> {
    let mut rest_s = substep_s;
    for _ in 0..=MAX_EVENTS {
        let end = system.flow(x, *mode, torque_nm, system.stride(rest_s));
        let violated = (0..S::GUARDS).filter(|&guard| system.guard(guard, &end, *mode, torque_nm) < 0.0);
        let located = violated.map(|guard| (locate(system, guard, x, *mode, torque_nm, rest_s), guard));
        let Some((event_s, guard)) = located.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            *x = end;
            return Ok(());
        };
        *x = system.flow(x, *mode, torque_nm, system.stride(event_s));
        *mode = system.switch(guard, x, *mode, torque_nm);
        rest_s -= event_s;
        if rest_s <= 0.0 {
            return Ok(());
        }
    }
    Err(PlantError::Chattering { substep_s })
}

/// Step length, just past the zero of a mode function that is negative after `limit_s`. The far side is returned so
/// that the mode that follows holds from its first instant.
fn locate<S: HybridSystem>(
    system: &S,
    guard: usize,
    x: &S::State,
    mode: S::Mode,
    torque_nm: f64,
    limit_s: f64,
) -> f64 {
    let value = |h_s: f64| {
        let end = system.flow(x, mode, torque_nm, system.stride(h_s));
        system.guard(guard, &end, mode, torque_nm)
    };
    let (mut near, mut far) = (0.0, limit_s);
    let (mut near_value, mut far_value) = (value(near), value(far));
    if near_value <= 0.0 {
        // The mode begins on its own edge: a load breaking away at no velocity, or rounding at a contact. Either it
        // leaves the edge and comes back later, or it ends at once.
        near = FIRST_INSTANT_SHARE * limit_s;
        near_value = value(near);
        if near_value <= 0.0 {
            return near;
        }
    }
    let mut last_kept = End::Neither;
    for _ in 0..MAX_TRIALS {
        if far - near <= BRACKET_SHARE * limit_s {
            break;
        }
        let trial = far - far_value * (far - near) / (far_value - near_value);
        let trial = if trial > near && trial < far { trial } else { 0.5 * (near + far) };
        let trial_value = value(trial);
        if trial_value == 0.0 {
            return trial;
        }
        // Illinois: an end kept twice in a row is weighed half, so that it can't stay for ever.
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

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    /// A ball under constant acceleration over a floor at nought, which it never leaves once it is there.
    struct Landing;

    impl HybridSystem for Landing {
        type State = Vector2<f64>;
        type Mode = bool;
        type Stride = f64;
        const GUARDS: usize = 1;

        fn stride(&self, h_s: f64) -> f64 {
            h_s
        }

        fn flow(&self, x: &Vector2<f64>, landed: bool, torque_nm: f64, h_s: f64) -> Vector2<f64> {
            let falling = |x: &Vector2<f64>, _| Vector2::new(x[1], torque_nm);
            if landed { *x } else { runge_kutta(x, h_s, &falling) }
        }

        fn guard(&self, _guard: usize, x: &Vector2<f64>, landed: bool, _torque_nm: f64) -> f64 {
            if landed { 1.0 } else { x[0] }
        }

        fn switch(&self, _guard: usize, x: &mut Vector2<f64>, _landed: bool, _torque_nm: f64) -> bool {
            x[0] = 0.0;
            true
        }

        fn settle(&self, _x: &mut Vector2<f64>, landed: bool, _torque_nm: f64) -> bool {
            landed
        }

        fn is_finite(&self, x: &Vector2<f64>) -> bool {
            x.iter().all(|coordinate| coordinate.is_finite())
        }
    }

    /// A system whose mode function is violated in both of its modes.
    struct Chatterer;

    impl HybridSystem for Chatterer {
        type State = Vector2<f64>;
        type Mode = bool;
        type Stride = f64;
        const GUARDS: usize = 1;

        fn stride(&self, h_s: f64) -> f64 {
            h_s
        }

        fn flow(&self, x: &Vector2<f64>, _mode: bool, _torque_nm: f64, _h_s: f64) -> Vector2<f64> {
            *x
        }

        fn guard(&self, _guard: usize, _x: &Vector2<f64>, _mode: bool, _torque_nm: f64) -> f64 {
            -1.0
        }

        fn switch(&self, _guard: usize, _x: &mut Vector2<f64>, mode: bool, _torque_nm: f64) -> bool {
            !mode
        }

        fn settle(&self, _x: &mut Vector2<f64>, mode: bool, _torque_nm: f64) -> bool {
            mode
        }

        fn is_finite(&self, _x: &Vector2<f64>) -> bool {
            true
        }
    }

    #[test]
    fn switch_is_located_where_the_closed_form_has_it() {
        // From 1 m at -9.81 m/s^2: down after sqrt(2 / 9.81) s at sqrt(2 * 9.81) m/s, within a single step of 1 s.
        let (mut x, mut landed) = (Vector2::new(1.0, 0.0), false);
        advance(&Landing, &mut x, &mut landed, -9.81, 1.0, 1).expect("lands");
        assert!(landed);
        assert_eq!(x[0], 0.0);
        let want = -(2.0_f64 * 9.81).sqrt();
        assert!((x[1] - want).abs() < 1e-11, "have {} m/s, want {want} m/s", x[1]);
    }

    #[test]
    fn endless_switching_is_an_error_that_says_chattering() {
        let error =
            advance(&Chatterer, &mut Vector2::zeros(), &mut false, 0.0, 1e-3, 4).expect_err("never ends");
        assert_eq!(error, PlantError::Chattering { substep_s: 2.5e-4 });
        assert!(error.to_string().starts_with("plant is chattering: more than 64 changes"), "{error}");
    }

    #[test]
    fn bad_input_is_refused_before_the_state_moves() {
        let (mut x, mut landed) = (Vector2::new(1.0, 0.0), false);
        let refused = advance(&Landing, &mut x, &mut landed, f64::NAN, 1.0, 1);
        assert!(matches!(refused, Err(PlantError::Torque { .. })));
        assert!(matches!(
            advance(&Landing, &mut x, &mut landed, 0.0, -1.0, 1),
            Err(PlantError::Duration { dt_s: -1.0 })
        ));
        assert_eq!(x, Vector2::new(1.0, 0.0));
    }

    #[test]
    fn overflow_of_the_state_is_an_error() {
        let (mut x, mut landed) = (Vector2::new(1.0, f64::MAX), false);
        let refused = advance(&Landing, &mut x, &mut landed, f64::MAX, 1e9, 1);
        assert!(matches!(refused, Err(PlantError::NotFinite { .. })), "{refused:?}");
    }
}
