//! Gains and limits of the backlash inverse.

use crate::control::parameter_error::at_most;
use crate::control::{ParameterError, Real};

/// Gains and limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashInverseGains<F> {
    /// Load error to wanted load velocity, 1/s.
    pub approach_rate_1_s: F,
    /// Largest wanted load velocity relative to the reference, in rad/s.
    pub approach_speed_rad_s: F,
    /// Load velocity error to torque at the load, N m s/rad.
    pub load_velocity_gain_nm_s_rad: F,
    /// Integral of the load velocity error to torque at the load, N m/rad.
    pub load_integral_gain_nm_rad: F,
    /// Largest torque of that integral at the load in N m.
    pub load_integral_limit_nm: F,
    /// Largest requested transmitted torque at the motor's side in N m.
    pub transmitted_limit_nm: F,
    /// Transmitted torque in N m within which the motor crosses the gap.
    pub gap_crossing_nm: F,
    /// Twist error to torque, N m/rad.
    pub twist_gain_nm_rad: F,
    /// Velocity of the twist to torque, N m s/rad.
    pub twist_damping_nm_s_rad: F,
    /// Triple pole of the load observer in rad/s.
    pub load_observer_rad_s: F,
    /// Smallest transmitted torque in N m at which the gap is identified.
    pub identification_min_nm: F,
    /// Load error in rad that counts as arrived; at least 1.05 counts of the load encoder are used.
    pub arrival_band_rad: F,
    /// Fraction of the integral kept on arrival.
    pub hold_fraction: F,
}

impl<F: Real> BacklashInverseGains<F> {
    /// Gains for the mechanics of table 1 behind encoders of some thousand counts, with up to 8 ms of delay.
    pub fn paper() -> Self {
        Self {
            approach_rate_1_s: F::from_f64(2.5),
            approach_speed_rad_s: F::from_f64(1.5),
            load_velocity_gain_nm_s_rad: F::from_f64(30.0),
            load_integral_gain_nm_rad: F::from_f64(150.0),
            load_integral_limit_nm: F::from_f64(8.0),
            transmitted_limit_nm: F::from_f64(8.0),
            gap_crossing_nm: F::from_f64(0.05),
            twist_gain_nm_rad: F::ONE,
            twist_damping_nm_s_rad: F::from_f64(0.04),
            load_observer_rad_s: F::from_f64(12.0),
            identification_min_nm: F::from_f64(0.4),
            arrival_band_rad: F::from_f64(0.002),
            hold_fraction: F::from_f64(0.3),
        }
    }

    /// Checks the gains that the period and the motor's inertia limit.
    ///
    /// # Errors
    /// Names the first gain beyond its limit.
    pub fn validate(&self, motor_inertia_kg_m2: F, period_s: F) -> Result<(), ParameterError> {
        // A held torque damps the motor within one period at most; a larger gain reverses the motion every period.
        at_most(
            "twist_damping_nm_s_rad",
            self.twist_damping_nm_s_rad,
            motor_inertia_kg_m2 / period_s,
            "motor_inertia_kg_m2 over the control period",
        )?;
        // Euler's rule advances the observer: it is unstable beyond 2 / period and coarse long before.
        at_most(
            "load_observer_rad_s",
            self.load_observer_rad_s,
            F::from_f64(0.5) / period_s,
            "half of 1 over the control period",
        )
    }
}
