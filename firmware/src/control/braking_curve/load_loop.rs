//! The load loop: load error to commanded transmitted torque, along the braking curve.
//!
//! A proportional-integral velocity loop with feed-forward of friction and of the curve's own deceleration. The curve is
//! entered with the error that the load will have after the lead time, because the shaft has to unwind before it brakes.
//!
//! On arrival the integral is unloaded once and frozen, and friction holds the load, as in
//! [`backlash_inverse`](crate::control::backlash_inverse). What friction can't hold, a lasting load, is not unloaded. The
//! integral has a limit, so that an approach doesn't wind it up; while the load stands off its target, the limit grows.

use super::curve::Curve;
use super::gains::BrakingCurveGains;
use super::inertia_factor::{InertiaFactor, InertiaFactorState};
use crate::control::load_observer::ObservedLoad;
use crate::control::nominal_model::NominalModel;
use crate::law::{Measurement, Real};

/// Fraction of the drive's torque limit that the transmitted torque may use; the rest moves the motor.
const TRANSMITTED_FRACTION: f64 = 0.95;
/// Load velocity over which the fed-forward friction reaches its full value, in rad/s.
const FRICTION_WIDTH_RAD_S: f64 = 0.15;
/// Load error below which the fed-forward friction fades, in rad.
const FRICTION_FADE_RAD: f64 = 0.1;
/// Smallest band in counts of the load encoder.
const BAND_COUNTS: f64 = 0.55;
/// Load error that ends a hold, in bands of arrival, or of 1.05 counts where those are wider.
const RELEASE_BANDS: f64 = 2.0;
const RELEASE_COUNTS: f64 = 1.05;
/// Load velocity of standstill in rad/s.
const STANDSTILL_RAD_S: f64 = 0.03;
/// Growth of the integral's limit at standstill, in N m/s at the load.
const REACH_NM_S: f64 = 10.0;
/// Largest stiction of the load in nominal Coulomb frictions.
const STICTION_RATIO: f64 = 1.4;

/// The loop with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoop<F> {
    gains: BrakingCurveGains<F>,
    curve: Curve<F>,
    inertia_factor: InertiaFactor<F>,
    inertia_kg_m2: F,
    friction_nm_s_rad: F,
    per_ratio: F,
    integral_per_period: F,
    reach_per_period_nm: F,
    stiction_nm: F,
    limit_nm: F,
    band_rad: F,
    release_rad: F,
}

/// State of the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoopState<F> {
    integral_nm: F,
    /// Growth of the integral's limit in N m.
    reach_nm: F,
    inertia_factor: InertiaFactorState<F>,
    pub(super) holding: bool,
}

fn larger<F: Real>(a: F, b: F) -> F {
    if a > b { a } else { b }
}

impl<F: Real> LoadLoop<F> {
    /// The loop for the load of `model` behind an encoder of this resolution.
    pub(super) fn new(
        model: &NominalModel<F>,
        gains: BrakingCurveGains<F>,
        load_resolution_rad: F,
        torque_limit_nm: F,
        period_s: F,
    ) -> Self {
        let usable_nm = F::from_f64(TRANSMITTED_FRACTION) * torque_limit_nm;
        let limit_nm = if gains.winding_limit_nm < usable_nm { gains.winding_limit_nm } else { usable_nm };
        let possible_rad_s2 = model.reduction_ratio * limit_nm / model.load_inertia_kg_m2;
        let deceleration =
            if gains.braking_rad_s2 < possible_rad_s2 { gains.braking_rad_s2 } else { possible_rad_s2 };
        let counts = |count: f64| F::from_f64(count) * load_resolution_rad;
        let band = gains.landing_band_rad;
        Self {
            gains,
            curve: Curve {
                deceleration_rad_s2: deceleration,
                rate_1_s: gains.braking_rate_1_s,
                landing_rate_1_s: gains.landing_rate_1_s,
                landing_rad: gains.landing_rad,
                top_speed_rad_s: gains.top_speed_rad_s,
            },
            inertia_factor: InertiaFactor::new(model, gains.load_coulomb_nm, period_s),
            inertia_kg_m2: model.load_inertia_kg_m2,
            friction_nm_s_rad: model.load_friction_nm_s_rad,
            per_ratio: F::ONE / model.reduction_ratio,
            integral_per_period: gains.speed_integral_gain_nm_rad * period_s,
            reach_per_period_nm: F::from_f64(REACH_NM_S) * period_s,
            stiction_nm: F::from_f64(STICTION_RATIO) * gains.load_coulomb_nm,
            limit_nm,
            // Half a count: the decoded position is the middle of a count.
            band_rad: larger(band - counts(0.5), counts(BAND_COUNTS)),
            release_rad: F::from_f64(RELEASE_BANDS) * larger(band, counts(RELEASE_COUNTS)),
        }
    }

    /// No hold, and an integral of zero.
    pub(super) fn initial_state() -> LoadLoopState<F> {
        LoadLoopState {
            integral_nm: F::ZERO,
            reach_nm: F::ZERO,
            inertia_factor: InertiaFactor::initial_state(),
            holding: false,
        }
    }

    /// The commanded transmitted torque at the motor in N m.
    pub(super) fn step(&self, state: &mut LoadLoopState<F>, m: &Measurement<F>, load: &ObservedLoad<F>) -> F {
        let load_velocity_rad_s = load.velocity_rad_s;
        let inertia_factor = self.inertia_factor.step(&mut state.inertia_factor, load);
        let gains = &self.gains;
        let error = m.load_position_rad - m.reference_position_rad;
        let reference_velocity = m.reference_velocity_rad_s;
        let excess_velocity = load_velocity_rad_s - reference_velocity;
        let arrived = error.abs() <= self.band_rad;
        if reference_velocity != F::ZERO || error.abs() > self.release_rad {
            state.holding = false;
        } else if arrived && !state.holding {
            state.holding = true;
            // What friction holds is unloaded, the lasting load beyond it is not.
            let lasting_nm =
                load.disturbance_nm - load.disturbance_nm.clamp(-self.stiction_nm, self.stiction_nm);
            state.integral_nm = lasting_nm + gains.landing_fraction * (state.integral_nm - lasting_nm);
        }
        let led_error = error + gains.braking_lead_s * excess_velocity;
        let distance = led_error.abs();
        let (commanded, acceleration) = if state.holding {
            (F::ZERO, F::ZERO)
        } else if arrived {
            (reference_velocity, F::ZERO)
        } else {
            let (velocity, slope) = self.curve.at(distance, inertia_factor);
            (reference_velocity - led_error.sign() * velocity, -(slope * excess_velocity))
        };
        let velocity_error = commanded - load_velocity_rad_s;
        let moving =
            ((commanded - reference_velocity) / F::from_f64(FRICTION_WIDTH_RAD_S)).clamp(-F::ONE, F::ONE);
        let fade = (distance / F::from_f64(FRICTION_FADE_RAD)).clamp(F::ZERO, F::ONE);
        let wanted_nm = self.per_ratio
            * (self.friction_nm_s_rad * commanded
                + self.inertia_kg_m2 * inertia_factor * acceleration
                + gains.load_coulomb_nm * moving * fade
                + gains.speed_gain_nm_s_rad * velocity_error
                + state.integral_nm);
        let torque_nm = wanted_nm.clamp(-self.limit_nm, self.limit_nm);
        // Anti-windup: the integral doesn't drive further into the limit.
        let at_limit = torque_nm != wanted_nm && wanted_nm * velocity_error > F::ZERO;
        if !state.holding && !at_limit {
            let integral_limit_nm = gains.speed_integral_limit_nm + state.reach_nm;
            let integral_nm = state.integral_nm + self.integral_per_period * velocity_error;
            state.integral_nm = integral_nm.clamp(-integral_limit_nm, integral_limit_nm);
            let stands = load_velocity_rad_s.abs() < F::from_f64(STANDSTILL_RAD_S);
            if stands && integral_nm != state.integral_nm {
                state.reach_nm += self.reach_per_period_nm;
            } else if state.integral_nm.abs() < gains.speed_integral_limit_nm {
                state.reach_nm = F::ZERO;
            }
        }
        torque_nm
    }
}
