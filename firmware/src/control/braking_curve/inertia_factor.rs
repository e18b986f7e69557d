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

/// Inertia in nominal inertias up to which the factor is 1. The impulse of unknown friction adds up to a quarter.
const TOLERATED: f64 = 1.35;
/// Largest factor.
const HEAVIEST: f64 = 3.0;
/// Load velocity in rad/s from which the momentum is much larger than its error.
const MOVING_RAD_S: f64 = 0.6;
/// Load velocity in rad/s beyond which the uncertain viscous friction outweighs the momentum.
const FAST_RAD_S: f64 = 1.3;
/// Load velocity in rad/s below which the momentum starts anew.
const RESTING_RAD_S: f64 = 0.05;
/// Bandwidth of the factor in rad/s.
const FOLLOW_RAD_S: f64 = 50.0;

/// The estimate with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InertiaFactor<F> {
    ratio: F,
    friction_nm_s_rad: F,
    coulomb_nm: F,
    per_tolerated_kg_m2: F,
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
    pub(super) fn new(model: &NominalModel<F>, coulomb_nm: F, period_s: F) -> Self {
        Self {
            ratio: model.reduction_ratio,
            friction_nm_s_rad: model.load_friction_nm_s_rad,
            coulomb_nm,
            per_tolerated_kg_m2: F::ONE / (F::from_f64(TOLERATED) * model.load_inertia_kg_m2),
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
        if velocity.abs() < F::from_f64(RESTING_RAD_S) {
            *state = Self::initial_state();
            return F::ONE;
        }
        let friction_nm = self.friction_nm_s_rad * velocity + self.coulomb_nm * velocity.sign();
        state.impulse_nm_s += self.period_s * (self.ratio * load.transmitted_nm - friction_nm);
        let speed = velocity.abs();
        state.fast |= speed > F::from_f64(FAST_RAD_S);
        if speed > F::from_f64(MOVING_RAD_S) && !state.fast {
            let inertia_kg_m2 = state.impulse_nm_s / velocity;
            let factor = (inertia_kg_m2 * self.per_tolerated_kg_m2).clamp(F::ONE, F::from_f64(HEAVIEST));
            let following = F::from_f64(FOLLOW_RAD_S) * self.period_s;
            state.factor += following.clamp(F::ZERO, F::ONE) * (factor - state.factor);
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
        let inertia_factor = InertiaFactor::new(&NominalModel::default(), 3.4, 1e-3);
        let mut state = InertiaFactor::initial_state();
        for k in 0..400 {
            let velocity_rad_s = 3.0 * 1e-3 * f64::from(k);
            let driving_nm = inertia_kg_m2 * 3.0 + 16.0 * velocity_rad_s + coulomb_nm;
            let load = ObservedLoad { velocity_rad_s, disturbance_nm: 0.0, transmitted_nm: driving_nm / 3.0 };
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
        for coulomb_nm in [2.4, 3.4, 4.4] {
            let (_, state) = factor_of(1.2 * NOMINAL_KG_M2, coulomb_nm);
            assert_eq!(state.factor, 1.0, "{coulomb_nm} N m");
        }
    }

    #[test]
    fn standstill_forgets_the_load() {
        let (inertia_factor, mut state) = factor_of(2.0 * NOMINAL_KG_M2, 3.4);
        let load = ObservedLoad { velocity_rad_s: 0.04, disturbance_nm: 0.0, transmitted_nm: 5.0 };
        assert_eq!(inertia_factor.step(&mut state, &load), 1.0);
        assert_eq!(state, InertiaFactor::initial_state());
    }
}
