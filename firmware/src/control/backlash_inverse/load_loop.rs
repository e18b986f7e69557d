//! The load loop: load error to requested transmitted torque.
//!
//! A proportional position loop around a proportional-integral velocity loop with feed-forward. On arrival inside the
//! band the integral is unloaded once and frozen, and friction holds the load: an integral that continues against dry
//! friction hunts at any gain (B. Armstrong, B. Amin, "PID control in the presence of static friction", Automatica
//! 32 (1996) 679-692). The hold ends when the reference moves or the load error exceeds [`RELEASE_BANDS`].
//!
//! Outside the band the loop acts on the whole error, not on the excess over the band. Otherwise a load that stopped
//! just outside would move again only after many seconds.

use super::gains::BacklashInverseGains;
use crate::control::nominal_model::NominalModel;
use crate::law::{Measurement, Real};

/// Load error that ends a hold, in bands.
const RELEASE_BANDS: f64 = 4.0;
/// Smallest band in counts of the load encoder; in a smaller band there may be no count.
const BAND_COUNTS: f64 = 1.05;

/// The loop with its constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoop<F> {
    gains: BacklashInverseGains<F>,
    friction_nm_s_rad: F,
    per_ratio: F,
    integral_per_period: F,
    band_rad: F,
    release_rad: F,
}

/// State of the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoadLoopState<F> {
    integral_nm: F,
    pub(super) holding: bool,
}

impl<F: Real> LoadLoop<F> {
    /// The loop for the load of `model` behind an encoder of this resolution.
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
            per_ratio: F::ONE / model.reduction_ratio,
            integral_per_period: gains.load_integral_gain_nm_rad * period_s,
            band_rad,
            release_rad: F::from_f64(RELEASE_BANDS) * band_rad,
        }
    }

    /// No hold, and an integral of zero.
    pub(super) fn initial_state() -> LoadLoopState<F> {
        LoadLoopState { integral_nm: F::ZERO, holding: false }
    }

    /// The requested transmitted torque at the motor's side in N m.
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
        // Anti-windup: the integral doesn't drive further into the limit.
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
        LoadLoop::new(&NominalModel::default(), BacklashInverseGains::default(), LSB_RAD, 1e-3)
    }

    fn at(load_position_rad: f64) -> Measurement<f64> {
        Measurement { load_position_rad, ..Measurement::default() }
    }

    /// The integral after this number of samples at rest at one position.
    fn integral_after(state: &mut LoadLoopState<f64>, load_position_rad: f64, samples: usize) -> f64 {
        for _ in 0..samples {
            load_loop().step(state, &at(load_position_rad), 0.0);
        }
        state.integral_nm
    }

    #[test]
    fn arrival_unloads_the_integral_once_and_freezes_it() {
        let mut state = LoadLoop::initial_state();
        let before = integral_after(&mut state, 0.01, 500);
        assert!(before < -1.0, "half a second off the reference loads the integral: {before} N m");
        let arrived = integral_after(&mut state, 0.001, 1);
        assert!(state.holding && (arrived - 0.3 * before).abs() < 1e-12, "have {arrived} N m");
        assert_eq!(integral_after(&mut state, 0.001, 5000), arrived, "frozen");
        assert_eq!(integral_after(&mut state, 0.0079, 5000), arrived, "no release within four bands");
    }

    #[test]
    fn a_moving_reference_or_a_load_off_its_place_ends_the_hold() {
        let mut state = LoadLoop::initial_state();
        integral_after(&mut state, 0.0, 1);
        assert!(state.holding);
        integral_after(&mut state, 0.0081, 1);
        assert!(!state.holding, "four bands of 2 mrad are left");
        integral_after(&mut state, 0.0, 1);
        assert!(state.holding, "and back again");
        let moving = Measurement { reference_velocity_rad_s: 0.01, ..at(0.0) };
        load_loop().step(&mut state, &moving, 0.0);
        assert!(!state.holding);
    }

    #[test]
    fn outside_the_band_the_whole_error_loads_the_integral() {
        let mut state = LoadLoop::initial_state();
        let after_a_second = integral_after(&mut state, 0.0021, 1000);
        // 150 N m/rad times 2.5 1/s times 2.1 mrad.
        assert!((after_a_second + 0.7875).abs() < 1e-9, "have {after_a_second} N m");
    }

    #[test]
    fn the_band_is_at_least_one_count_wide() {
        let coarse = LoadLoop::new(&NominalModel::default(), BacklashInverseGains::default(), 0.01, 1e-3);
        let mut state = LoadLoop::initial_state();
        coarse.step(&mut state, &at(0.01), 0.0);
        assert!(state.holding, "one count off the reference is within the resolution");
    }

    #[test]
    fn the_integral_does_not_wind_up_at_the_torque_limit() {
        let mut state = LoadLoop::initial_state();
        let far = at(2.0);
        let torque = load_loop().step(&mut state, &far, 0.0);
        assert_eq!(torque, -8.0, "the limit of the transmitted torque");
        assert_eq!(integral_after(&mut state, 2.0, 10_000), 0.0, "ten seconds at the limit");
        // A velocity error that leads out of the limit is integrated.
        load_loop().step(&mut state, &far, -2.0);
        assert!(state.integral_nm > 0.0);
    }

    #[test]
    fn integral_stays_within_its_limit() {
        let mut state = LoadLoop::initial_state();
        assert_eq!(integral_after(&mut state, 0.05, 100_000), -8.0);
    }
}
