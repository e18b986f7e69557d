//! The load loop: load error to commanded transmitted torque, along the braking curve.
//!
//! A proportional-integral velocity loop with feed-forward of friction and of the curve's own deceleration. The curve is
//! entered with the error that the load will have after the lead time, because the shaft has to unwind before it brakes.
//!
//! On arrival the integral is unloaded once and frozen, and friction holds the load, as in
//! [`backlash_inverse`](crate::control::backlash_inverse). What friction can't hold, a lasting load, is not unloaded. The
//! integral has a limit, so that an approach doesn't wind it up; while the load stands off its target, the limit grows.
//! [`hunting`](super::hunting) widens the hold and slows the loop of a load that swings through its target.

use super::curve::Curve;
use super::gains::Gains;
use super::hunting::HuntingState;
use super::inertia_factor::{InertiaFactor, InertiaFactorState};
use crate::control::load_observer::ObservedLoad;
use crate::control::nominal_model::NominalModel;
use crate::law::{Measurement, Real};

/// Fraction of the integral that remains on arrival.
const LANDING_FRACTION: f64 = 0.3;
/// Largest stiction of the load in nominal Coulomb frictions.
const STICTION_RATIO: f64 = 1.4;

/// The loop with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoop<F> {
    gains: Gains<F>,
    coulomb_nm: F,
    curve: Curve<F>,
    inertia_factor: InertiaFactor<F>,
    inertia_kg_m2: F,
    friction_nm_s_rad: F,
    per_ratio: F,
    integral_per_period: F,
    reach_per_period_nm: F,
    stiction_nm: F,
    per_width_s_rad: F,
    per_fade_1_rad: F,
}

/// State of the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoopState<F> {
    integral_nm: F,
    /// Growth of the integral's limit in N m.
    reach_nm: F,
    inertia_factor: InertiaFactorState<F>,
    hunting: HuntingState<F>,
    pub(super) holding: bool,
}

/// What the loop commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadCommand<F> {
    /// Transmitted torque at the motor in N m.
    pub(super) torque_nm: F,
    /// Planned acceleration of the load in rad/s^2.
    pub(super) acceleration_rad_s2: F,
}

impl<F: Real> LoadLoop<F> {
    /// The loop for the load of `model`, with this Coulomb friction.
    pub(super) fn new(model: &NominalModel<F>, gains: &Gains<F>, coulomb_nm: F, period_s: F) -> Self {
        let speed_rad_s = gains.braking_rad_s2 / gains.rate_1_s;
        Self {
            gains: *gains,
            coulomb_nm,
            curve: Curve {
                deceleration_rad_s2: gains.braking_rad_s2,
                rate_1_s: gains.rate_1_s,
                landing_rate_1_s: gains.landing_rate_1_s,
                landing_rad: gains.landing_rad,
                top_speed_rad_s: gains.top_speed_rad_s,
            },
            inertia_factor: InertiaFactor::new(model, coulomb_nm, speed_rad_s, gains.rate_1_s, period_s),
            inertia_kg_m2: model.load_inertia_kg_m2,
            friction_nm_s_rad: model.load_friction_nm_s_rad,
            per_ratio: F::ONE / model.reduction_ratio,
            integral_per_period: gains.integral_nm_rad * period_s,
            reach_per_period_nm: gains.reach_nm_s * period_s,
            stiction_nm: F::from_f64(STICTION_RATIO) * coulomb_nm,
            per_width_s_rad: F::ONE / gains.friction_width_rad_s,
            per_fade_1_rad: F::ONE / gains.friction_fade_rad,
        }
    }

    /// No hold, and an integral of zero.
    pub(super) fn initial_state() -> LoadLoopState<F> {
        LoadLoopState {
            integral_nm: F::ZERO,
            reach_nm: F::ZERO,
            inertia_factor: InertiaFactor::initial_state(),
            hunting: HuntingState::at(F::ZERO),
            holding: false,
        }
    }

    /// The command for this sample. `missing_nm` is the torque that the motor was commanded and didn't give, or zero.
    pub(super) fn step(
        &self,
        state: &mut LoadLoopState<F>,
        m: &Measurement<F>,
        load: &ObservedLoad<F>,
        missing_nm: F,
    ) -> LoadCommand<F> {
        let load_velocity_rad_s = load.velocity_rad_s;
        let inertia_factor = self.inertia_factor.step(&mut state.inertia_factor, load);
        let gains = &self.gains;
        // The observed position: counts and their noise would wind the shaft at every sample.
        let error = m.load_position_rad - load.position_error_rad - m.reference_position_rad;
        let reference_velocity = m.reference_velocity_rad_s;
        let excess_velocity = load_velocity_rad_s - reference_velocity;
        state.hunting.step(m, error, gains.release_rad);
        let (widening, calm) = (state.hunting.widening, state.hunting.calm);
        let arrived = error.abs() <= widening * gains.band_rad;
        if reference_velocity != F::ZERO || error.abs() > widening * gains.release_rad {
            state.holding = false;
        } else if arrived && !state.holding {
            state.holding = true;
            // What friction holds is unloaded, the lasting load beyond it is not.
            let lasting_nm =
                load.disturbance_nm - load.disturbance_nm.clamp(-self.stiction_nm, self.stiction_nm);
            state.integral_nm = lasting_nm + F::from_f64(LANDING_FRACTION) * (state.integral_nm - lasting_nm);
        }
        let led_error = error + gains.lead_s * excess_velocity;
        let distance = led_error.abs();
        let (commanded, acceleration) = if state.holding {
            (F::ZERO, F::ZERO)
        } else if arrived {
            (reference_velocity, F::ZERO)
        } else {
            let (velocity, slope) = self.curve.at(distance, inertia_factor);
            (reference_velocity - led_error.sign() * (calm * velocity), -(calm * slope * excess_velocity))
        };
        let velocity_error = commanded - load_velocity_rad_s;
        let stands = load_velocity_rad_s.abs() < gains.standstill_rad_s;
        // Friction damps a load that it holds; the observed velocity would only add its noise.
        let damping = if state.holding && stands { F::ZERO } else { calm * gains.speed_nm_s_rad };
        let moving = (self.per_width_s_rad * (commanded - reference_velocity)).clamp(-F::ONE, F::ONE);
        let fade = (self.per_fade_1_rad * distance).clamp(F::ZERO, F::ONE);
        let wanted_nm = self.per_ratio
            * (self.friction_nm_s_rad * commanded
                + self.inertia_kg_m2 * inertia_factor * acceleration
                + self.coulomb_nm * moving * fade
                + damping * velocity_error
                + state.integral_nm);
        let torque_nm = wanted_nm.clamp(-gains.transmitted_nm, gains.transmitted_nm);
        // Anti-windup: the integral doesn't drive further into the limit, nor into a torque that the motor doesn't give.
        let at_limit = torque_nm != wanted_nm && wanted_nm * velocity_error > F::ZERO
            || missing_nm * velocity_error > F::ZERO;
        if !state.holding && !at_limit {
            let integral_limit_nm = gains.integral_limit_nm + state.reach_nm;
            let integral_nm = state.integral_nm + calm * calm * self.integral_per_period * velocity_error;
            state.integral_nm = integral_nm.clamp(-integral_limit_nm, integral_limit_nm);
            if stands && integral_nm != state.integral_nm {
                state.reach_nm += self.reach_per_period_nm;
            } else if state.integral_nm.abs() < gains.integral_limit_nm {
                state.reach_nm = F::ZERO;
            }
        }
        LoadCommand { torque_nm, acceleration_rad_s2: acceleration }
    }
}
