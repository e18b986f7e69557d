//! The load loop: from the load's error to the torque the transmission is to carry.
//!
//! A proportional position loop around a proportional-integral velocity loop with feed-forward. On arrival inside the
//! band the integral is unloaded once and frozen, and friction holds the load: an integral that goes on against dry
//! friction hunts whatever its gain (B. Armstrong, B. Amin, "PID control in the presence of static friction", Automatica
//! 32 (1996) 679-692). The hold ends when the reference moves or the load has left the band by
//! [`RELEASE_BANDS`].
//!
//! Outside the band the whole error counts, not what exceeds the band. Otherwise a load that stopped just outside
//! would be pushed again only after many seconds.

use super::gains::BacklashInverseGains;
use crate::control::nominal_model::NominalModel;
use crate::control::{Measurement, Real};

/// Load error that ends a hold, in bands.
const RELEASE_BANDS: f64 = 4.0;
/// A band is at least this many counts of the load encoder; otherwise no count might lie within it.
const BAND_COUNTS: f64 = 1.05;

/// The loop with everything about it worked out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoop<F> {
    gains: BacklashInverseGains<F>,
    friction_nm_s_rad: F,
    per_ratio: F,
    integral_per_period: F,
    band_rad: F,
    release_rad: F,
}

/// What the loop remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoopState<F> {
    integral_nm: F,
    pub(super) holding: bool,
}

impl<F: Real> LoadLoop<F> {
    /// The loop for the load of `model` behind an encoder of this resolution. Gains have been checked.
    pub(super) fn new(
        model: &NominalModel<F>,
        gains: BacklashInverseGains<F>,
        load_resolution_rad: F,
        period_s: F,
    ) -> Self {
        let counts_rad = F::from_f64(BAND_COUNTS) * load_resolution_rad;
        let band_rad = if gains.arrival_band_rad > counts_rad { gains.arrival_band_rad } else { counts_rad };
        Self {
            gains,
            friction_nm_s_rad: model.load_friction_nm_s_rad,
            per_ratio: F::ONE / model.ratio,
            integral_per_period: gains.load_integral_gain_nm_rad * period_s,
            band_rad,
            release_rad: F::from_f64(RELEASE_BANDS) * band_rad,
        }
    }

    /// A loop that is not holding and has integrated nothing.
    pub(super) fn initial_state() -> LoadLoopState<F> {
        LoadLoopState { integral_nm: F::ZERO, holding: false }
    }

    /// The torque in N m the transmission is to carry, at the motor's side.
    pub(super) fn step(&self, state: &mut LoadLoopState<F>, m: &Measurement<F>, load_velocity_rad_s: F) -> F {
        let error = m.load_position_rad - m.reference_position_rad;
        let reference_velocity = m.reference_velocity_rad_s;
        let arrived = error.abs() <= self.band_rad;
        if reference_velocity != F::ZERO || error.abs() > self.release_rad {
            state.holding = false;
        } else if arrived && !state.holding {
            state.holding = true;
            state.integral_nm *= self.gains.hold_fraction;
        }
        let approach_speed = self.gains.approach_speed_rad_s;
        let wanted_velocity = if state.holding {
            F::ZERO
        } else if arrived {
            reference_velocity
        } else {
            reference_velocity - (self.gains.approach_rate_1_s * error).clamp(-approach_speed, approach_speed)
        };
        let velocity_error = wanted_velocity - load_velocity_rad_s;
        let wanted_nm = self.per_ratio
            * (self.friction_nm_s_rad * wanted_velocity
                + self.gains.load_velocity_gain_nm_s_rad * velocity_error
                + state.integral_nm);
        let limit_nm = self.gains.transmitted_limit_nm;
        let torque_nm = wanted_nm.clamp(-limit_nm, limit_nm);
        // Nothing is integrated that would only lead deeper into the limit.
        let at_limit = torque_nm != wanted_nm && wanted_nm * velocity_error > F::ZERO;
        if !state.holding && !at_limit {
            let limit_nm = self.gains.load_integral_limit_nm;
            state.integral_nm =
                (state.integral_nm + self.integral_per_period * velocity_error).clamp(-limit_nm, limit_nm);
        }
        torque_nm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LSB_RAD: f64 = core::f64::consts::TAU / 4000.0;

    fn load_loop() -> LoadLoop<f64> {
        LoadLoop::new(&NominalModel::paper(), BacklashInverseGains::paper(), LSB_RAD, 1e-3)
    }

    fn at(load_position_rad: f64) -> Measurement<f64> {
        Measurement { load_position_rad, ..Measurement::at_rest() }
    }

    /// The integral after a while at rest at one place.
    fn waited(state: &mut LoadLoopState<f64>, load_position_rad: f64, samples: usize) -> f64 {
        for _ in 0..samples {
            load_loop().step(state, &at(load_position_rad), 0.0);
        }
        state.integral_nm
    }

    #[test]
    fn arrival_unloads_the_integral_once_and_freezes_it() {
        let mut state = LoadLoop::initial_state();
        let before = waited(&mut state, 0.01, 500);
        assert!(before < -1.0, "half a second beside the reference loads the integral: {before} N m");
        let arrived = waited(&mut state, 0.001, 1);
        assert!(state.holding && (arrived - 0.3 * before).abs() < 1e-12, "have {arrived} N m");
        assert_eq!(waited(&mut state, 0.001, 5000), arrived, "frozen");
        assert_eq!(waited(&mut state, 0.0079, 5000), arrived, "a load within four bands is left alone");
    }

    #[test]
    fn hold_is_released_by_a_moving_reference_and_by_a_load_that_left() {
        let mut state = LoadLoop::initial_state();
        waited(&mut state, 0.0, 1);
        assert!(state.holding);
        waited(&mut state, 0.0081, 1);
        assert!(!state.holding, "four bands of 2 mrad are left");
        waited(&mut state, 0.0, 1);
        assert!(state.holding, "and back again");
        let moving = Measurement { reference_velocity_rad_s: 0.01, ..at(0.0) };
        load_loop().step(&mut state, &moving, 0.0);
        assert!(!state.holding);
    }

    #[test]
    fn just_outside_the_band_the_integral_is_loaded_by_the_whole_error() {
        let mut state = LoadLoop::initial_state();
        let after_a_second = waited(&mut state, 0.0021, 1000);
        // 150 N m/rad times 2.5 1/s times 2.1 mrad.
        assert!((after_a_second + 0.7875).abs() < 1e-9, "have {after_a_second} N m");
    }

    #[test]
    fn no_band_is_finer_than_a_count() {
        let coarse = LoadLoop::new(&NominalModel::paper(), BacklashInverseGains::paper(), 0.01, 1e-3);
        let mut state = LoadLoop::initial_state();
        coarse.step(&mut state, &at(0.01), 0.0);
        assert!(state.holding, "one count beside the reference is as near as this encoder gets");
    }

    #[test]
    fn nothing_is_wound_up_at_the_torque_limit() {
        let mut state = LoadLoop::initial_state();
        let far = at(2.0);
        let torque = load_loop().step(&mut state, &far, 0.0);
        assert_eq!(torque, -8.0, "the limit of the transmitted torque");
        assert_eq!(waited(&mut state, 2.0, 10_000), 0.0, "ten seconds at the limit");
        // A velocity beyond the wanted one leads out of the limit and is integrated.
        load_loop().step(&mut state, &far, -2.0);
        assert!(state.integral_nm > 0.0);
    }

    #[test]
    fn integral_stays_within_its_limit() {
        let mut state = LoadLoop::initial_state();
        assert_eq!(waited(&mut state, 0.05, 100_000), -8.0);
    }
}
