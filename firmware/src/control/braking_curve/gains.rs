//! Gains and limits of the braking-curve law.

use crate::law::{ParameterError, Real};

crate::parameters! {
    /// Gains and limits, by default for the mechanics of table 1 within 30 %, behind encoders of some thousand counts.
    pub struct BrakingCurveGains<F> {
        /// Deceleration of the braking curve; the transmitted torque may limit it further.
        braking_rad_s2: F32 = 5.8 in 1e-3..=1e6, "rad/s^2";
        /// Slope of the braking curve where the load velocity leaves the square root.
        braking_rate_1_s: F32 = 10.0 in 0.01..=1e4, "1/s";
        /// Slope of the braking curve at the target.
        landing_rate_1_s: F32 = 1.65 in 0.01..=1e4, "1/s";
        /// Load error at which the slope begins to fall to `landing_rate_1_s`.
        landing_rad: F32 = 0.047 in 1e-6..=1e3, "rad";
        /// Largest commanded load velocity relative to the reference.
        top_speed_rad_s: F32 = 3.0 in 0.0..=1e6, "rad/s";
        /// Time by which the braking curve leads: load velocity to load error.
        braking_lead_s: F32 = 0.035 in 0.0..=10.0, "s";
        /// Load velocity error to torque at the load.
        speed_gain_nm_s_rad: F32 = 42.0 in 0.0..=1e6, "N m s/rad";
        /// Integral of the load velocity error to torque at the load.
        speed_integral_gain_nm_rad: F32 = 220.0 in 0.0..=1e6, "N m/rad";
        /// Limit of that integral at the load.
        speed_integral_limit_nm: F32 = 7.2 in 0.0..=1e6, "N m";
        /// Nominal dry friction of the load, fed forward in motion.
        load_coulomb_nm: F32 = 3.4 in 0.0..=1e6, "N m";
        /// Largest commanded transmitted torque at the motor; never more than 0.95 `torque_limit_nm`.
        winding_limit_nm: F32 = 18.0 in 0.0..=1e6, "N m";
        /// Double pole with which the transmitted torque follows its command.
        winding_rad_s: F32 = 39.0 in 0.1..=1e4, "rad/s";
        /// Largest motor speed relative to the load while the shaft winds.
        winding_speed_rad_s: F32 = 600.0 in 0.0..=1e6, "rad/s";
        /// Transmitted torque within which the motor crosses the gap.
        crossing_nm: F32 = 0.05 in 1e-6..=1e6, "N m";
        /// Twist error to torque.
        shaft_gain_nm_rad: F32 = 1.0 in 0.0..=1e6, "N m/rad";
        /// Velocity of the twist to torque; at most the motor's inertia divided by the control period.
        shaft_damping_nm_s_rad: F32 = 0.04 in 0.0..=1e6, "N m s/rad";
        /// Pole of the observer of the transmitted torque.
        shaft_observer_rad_s: F32 = 80.0 in 0.1..=1e4, "rad/s";
        /// Triple pole of the load observer; at most 0.5 divided by the control period.
        speed_observer_rad_s: F32 = 20.0 in 0.1..=1e4, "rad/s";
        /// Smallest transmitted torque at which the gap is identified.
        learning_min_nm: F32 = 0.4 in 0.0..=1e6, "N m";
        /// Load error of arrival.
        landing_band_rad: F32 = 0.002 in 0.0..=1.0, "rad";
        /// Fraction of the integral that remains on arrival.
        landing_fraction: F32 = 0.3 in 0.0..=1.0, "";
    }
}

impl<F: Real> BrakingCurveGains<F> {
    /// Checks the gains that the period and the motor's inertia limit.
    ///
    /// # Errors
    /// Names the first gain beyond its limit.
    pub fn validate(&self, motor_inertia_kg_m2: F, period_s: F) -> Result<(), ParameterError> {
        // A held torque damps the motor within one period at most; a larger gain reverses the motion every period.
        ParameterError::at_most(
            "shaft_damping_nm_s_rad",
            self.shaft_damping_nm_s_rad,
            motor_inertia_kg_m2 / period_s,
            "motor_inertia_kg_m2 divided by the control period",
        )?;
        // Euler's rule advances the observer and the winding: both are unstable beyond 2 / period and coarse long before.
        let fastest_rad_s = F::from_f64(0.5) / period_s;
        let reason = "0.5 divided by the control period";
        ParameterError::at_most("speed_observer_rad_s", self.speed_observer_rad_s, fastest_rad_s, reason)?;
        ParameterError::at_most("winding_rad_s", self.winding_rad_s, fastest_rad_s, reason)?;
        ParameterError::at_most(
            "landing_rate_1_s",
            self.landing_rate_1_s,
            self.braking_rate_1_s,
            "braking_rate_1_s",
        )
    }
}
