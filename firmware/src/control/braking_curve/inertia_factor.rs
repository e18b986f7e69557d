//! The load's inertia from its momentum, for a load far heavier than nominal.
//!
//! From standstill, the momentum of the load is the impulse of what drives it:
//!
//! ```text
//! P = integral of (N0 C_obs - f_s v - F_c sgn v) dt,   J = P / v
//! ```
//!
//! Loads up to [`TOLERATED`] times the nominal inertia need no adaptation: the braking curve is planned for them. A heavier
//! load brakes earlier, by the factor that this module gives.

use crate::control::load_observer::ObservedLoad;
use crate::control::nominal_model::NominalModel;
use crate::law::Real;

/// Inertia in nominal inertias up to which the factor is 1. The impulse of unknown friction adds up to a quarter, so that a load
/// within 30 % brakes earlier by at most half.
const TOLERATED: f64 = 1.12;
/// Largest factor.
const HEAVIEST: f64 = 3.0;
/// Load velocity from which the momentum is much larger than its error, relative to the velocity at which the curve's root ends.
const MOVING: f64 = 0.93;
/// That beyond which the uncertain viscous friction outweighs the momentum.
const FAST: f64 = 2.0;
/// That below which the momentum starts anew.
const RESTING: f64 = 0.078;
/// Bandwidth of the factor relative to the slope of the curve.
const FOLLOW: f64 = 5.5;

/// The estimate with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InertiaFactor<F> {
    ratio: F,
    friction_nm_s_rad: F,
    coulomb_nm: F,
    per_tolerated_kg_m2: F,
    moving_rad_s: F,
    fast_rad_s: F,
    resting_rad_s: F,
    following: F,
    period_s: F,
}

/// State of the estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InertiaFactorState<F> {
    impulse_nm_s: F,
    factor: F,
    /// Whether the load was fast since its standstill.
    fast: bool,
}

impl<F: Real> InertiaFactor<F> {
    /// `speed_rad_s` is the load velocity at which the root of the braking curve ends, and `rate_1_s` its slope there.
    pub(super) fn new(
        model: &NominalModel<F>,
        coulomb_nm: F,
        speed_rad_s: F,
        rate_1_s: F,
        period_s: F,
    ) -> Self {
        Self {
            ratio: model.reduction_ratio,
            friction_nm_s_rad: model.load_friction_nm_s_rad,
            coulomb_nm,
            per_tolerated_kg_m2: F::ONE / (F::from_f64(TOLERATED) * model.load_inertia_kg_m2),
            moving_rad_s: F::from_f64(MOVING) * speed_rad_s,
            fast_rad_s: F::from_f64(FAST) * speed_rad_s,
            resting_rad_s: F::from_f64(RESTING) * speed_rad_s,
            following: (F::from_f64(FOLLOW) * rate_1_s * period_s).clamp(F::ZERO, F::ONE),
            period_s,
        }
    }

    /// No momentum, and a factor of 1.
    pub(super) fn initial_state() -> InertiaFactorState<F> {
        InertiaFactorState { impulse_nm_s: F::ZERO, factor: F::ONE, fast: false }
    }

    /// The inertia in tolerated inertias after this sample, from 1 on.
    pub(super) fn step(&self, state: &mut InertiaFactorState<F>, load: &ObservedLoad<F>) -> F {
        let velocity = load.velocity_rad_s;
        if velocity.abs() < self.resting_rad_s {
            *state = Self::initial_state();
            return F::ONE;
        }
        let friction_nm = self.friction_nm_s_rad * velocity + self.coulomb_nm * velocity.sign();
        state.impulse_nm_s += self.period_s * (self.ratio * load.transmitted_nm - friction_nm);
        let speed = velocity.abs();
        state.fast |= speed > self.fast_rad_s;
        if speed > self.moving_rad_s && !state.fast {
            let inertia_kg_m2 = state.impulse_nm_s / velocity;
            let factor = (inertia_kg_m2 * self.per_tolerated_kg_m2).clamp(F::ONE, F::from_f64(HEAVIEST));
            state.factor += self.following * (factor - state.factor);
        }
        state.factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOMINAL_KG_M2: f64 = 7.5;

    /// The factor after a load with this inertia and dry friction has accelerated with 3 rad/s^2 to 1.2 rad/s.
    fn factor_of(inertia_kg_m2: f64, coulomb_nm: f64) -> (InertiaFactor<f64>, InertiaFactorState<f64>) {
        let inertia_factor = InertiaFactor::new(&NominalModel::default(), 3.4, 0.644, 9.05, 1e-3);
        let mut state = InertiaFactor::initial_state();
        for k in 0..400 {
            let velocity_rad_s = 3.0 * 1e-3 * f64::from(k);
            let driving_nm = inertia_kg_m2 * 3.0 + 16.0 * velocity_rad_s + coulomb_nm;
            let load = ObservedLoad {
                velocity_rad_s,
                disturbance_nm: 0.0,
                transmitted_nm: driving_nm / 3.0,
                position_error_rad: 0.0,
            };
            inertia_factor.step(&mut state, &load);
        }
        (inertia_factor, state)
    }

    #[test]
    fn factor_converges_to_the_inertia_of_a_heavy_load() {
        for times in [1.6, 2.0, 2.7] {
            let (_, state) = factor_of(times * NOMINAL_KG_M2, 3.4);
            // Below the speed of rest no impulse counts, which the momentum contains.
            let want = times / TOLERATED;
            assert!((state.factor / want - 1.0).abs() < 0.06, "{times}: have {}, want {want}", state.factor);
        }
    }

    #[test]
    fn friction_of_a_tolerated_load_leaves_the_factor_at_one() {
        for (times, coulomb_nm) in [(1.0, 3.4), (1.0, 2.4), (0.7, 4.4)] {
            let (_, state) = factor_of(times * NOMINAL_KG_M2, coulomb_nm);
            assert_eq!(state.factor, 1.0, "{times}, {coulomb_nm} N m");
        }
    }

    #[test]
    fn standstill_forgets_the_load() {
        let (inertia_factor, mut state) = factor_of(2.0 * NOMINAL_KG_M2, 3.4);
        let load = ObservedLoad {
            velocity_rad_s: 0.04,
            disturbance_nm: 0.0,
            transmitted_nm: 5.0,
            position_error_rad: 0.0,
        };
        assert_eq!(inertia_factor.step(&mut state, &load), 1.0);
        assert_eq!(state, InertiaFactor::initial_state());
    }
}
