//! Gains and limits of the backlash inverse.

use crate::law::{ParameterError, Real};

crate::parameters! {
    /// Gains and limits, by default for the mechanics of table 1 behind encoders of some thousand counts, with up to 8 ms
    /// of delay.
    pub struct BacklashInverseGains<F> {
        /// Load error to wanted load velocity.
        approach_rate_1_s: F32 = 2.5 in 0.0..=1e6, "1/s";
        /// Largest wanted load velocity relative to the reference.
        approach_speed_rad_s: F32 = 1.5 in 0.0..=1e6, "rad/s";
        /// Load velocity error to torque at the load.
        load_velocity_gain_nm_s_rad: F32 = 30.0 in 0.0..=1e6, "N m s/rad";
        /// Integral of the load velocity error to torque at the load.
        load_integral_gain_nm_rad: F32 = 150.0 in 0.0..=1e6, "N m/rad";
        /// Largest torque of that integral at the load.
        load_integral_limit_nm: F32 = 8.0 in 0.0..=1e6, "N m";
        /// Largest requested transmitted torque at the motor's side; never more than `torque_limit_nm`.
        transmitted_limit_nm: F32 = 8.0 in 0.0..=1e6, "N m";
        /// Transmitted torque within which the motor crosses the gap.
        gap_crossing_nm: F32 = 0.05 in 1e-6..=1e6, "N m";
        /// Twist error to torque.
        twist_gain_nm_rad: F32 = 1.0 in 0.0..=1e6, "N m/rad";
        /// Velocity of the twist to torque; at most the motor's inertia over the control period.
        twist_damping_nm_s_rad: F32 = 0.04 in 0.0..=1e6, "N m s/rad";
        /// Triple pole of the load observer; at most half of 1 over the control period.
        load_observer_rad_s: F32 = 12.0 in 0.1..=1e4, "rad/s";
        /// Smallest transmitted torque at which the gap is identified.
        identification_min_nm: F32 = 0.4 in 0.0..=1e6, "N m";
        /// Load error that counts as arrived; at least 1.05 counts of the load encoder are used.
        arrival_band_rad: F32 = 0.002 in 0.0..=1.0, "rad";
        /// Fraction of the integral kept on arrival.
        hold_fraction: F32 = 0.3 in 0.0..=1.0, "";
    }
}

impl<F: Real> BacklashInverseGains<F> {
    /// Checks the gains that the period and the motor's inertia limit.
    ///
    /// # Errors
    /// Names the first gain beyond its limit.
    pub fn validate(&self, motor_inertia_kg_m2: F, period_s: F) -> Result<(), ParameterError> {
        // A held torque damps the motor within one period at most; a larger gain reverses the motion every period.
        ParameterError::at_most(
            "twist_damping_nm_s_rad",
            self.twist_damping_nm_s_rad,
            motor_inertia_kg_m2 / period_s,
            "motor_inertia_kg_m2 over the control period",
        )?;
        // Euler's rule advances the observer: it is unstable beyond 2 / period and coarse long before.
        ParameterError::at_most(
            "load_observer_rad_s",
            self.load_observer_rad_s,
            F::from_f64(0.5) / period_s,
            "half of 1 over the control period",
        )
    }
}
