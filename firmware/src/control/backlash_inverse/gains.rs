//! What may be tuned in the backlash inverse.

use crate::control::parameter::{GAIN_MAX, Limits, all_within, within};
use crate::control::{ParameterError, Real};

/// What each of them may be, but for the two that depend on the period.
const LIMITS: [Limits; 11] = [
    ("approach_rate_1_s", 0.0, GAIN_MAX),
    ("approach_speed_rad_s", 0.0, GAIN_MAX),
    ("load_velocity_gain_nm_s_rad", 0.0, GAIN_MAX),
    ("load_integral_gain_nm_rad", 0.0, GAIN_MAX),
    ("load_integral_limit_nm", 0.0, GAIN_MAX),
    ("transmitted_limit_nm", 0.0, GAIN_MAX),
    ("gap_crossing_nm", 1e-6, GAIN_MAX),
    ("twist_gain_nm_rad", 0.0, GAIN_MAX),
    ("identification_min_nm", 0.0, GAIN_MAX),
    ("arrival_band_rad", 0.0, 1.0),
    ("hold_fraction", 0.0, 1.0),
];

/// Gains and limits of the backlash inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashInverseGains<F> {
    /// Load error to wanted load velocity, 1/s.
    pub approach_rate_1_s: F,
    /// Fastest wanted load velocity beyond the reference's own, in rad/s.
    pub approach_speed_rad_s: F,
    /// Load velocity error to torque at the load, N m s/rad.
    pub load_velocity_gain_nm_s_rad: F,
    /// Integral of the load velocity error to torque at the load, N m/rad.
    pub load_integral_gain_nm_rad: F,
    /// Largest torque of that integral at the load in N m.
    pub load_integral_limit_nm: F,
    /// Largest torque asked of the transmission, at the motor's side, in N m.
    pub transmitted_limit_nm: F,
    /// Transmitted torque in N m within which the motor is sent from one side of the gap to the other.
    pub gap_crossing_nm: F,
    /// Twist error to torque, N m/rad.
    pub twist_gain_nm_rad: F,
    /// Velocity of the twist to torque, N m s/rad.
    pub twist_damping_nm_s_rad: F,
    /// Triple pole of the load observer in rad/s.
    pub load_observer_rad_s: F,
    /// Smallest transmitted torque in N m at which the gap is identified.
    pub identification_min_nm: F,
    /// Load error in rad that counts as arrived, if the load encoder can tell it.
    pub arrival_band_rad: F,
    /// Share of the integral that is kept on arrival.
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

    /// Checks every gain, and those that the period and the motor's inertia set a limit to.
    ///
    /// # Errors
    /// Names the first gain outside its range.
    pub fn validate(&self, motor_inertia_kg_m2: F, period_s: F) -> Result<(), ParameterError> {
        all_within(
            &LIMITS,
            [
                self.approach_rate_1_s,
                self.approach_speed_rad_s,
                self.load_velocity_gain_nm_s_rad,
                self.load_integral_gain_nm_rad,
                self.load_integral_limit_nm,
                self.transmitted_limit_nm,
                self.gap_crossing_nm,
                self.twist_gain_nm_rad,
                self.identification_min_nm,
                self.arrival_band_rad,
                self.hold_fraction,
            ],
        )?;
        // A held torque damps the motor within one period at most; beyond that it drives it to and fro.
        let damping_max = (motor_inertia_kg_m2 / period_s).to_f64() as f32;
        within("twist_damping_nm_s_rad", self.twist_damping_nm_s_rad, 0.0, damping_max)?;
        // The observer is advanced by Euler's rule, which is unstable beyond 2 / period and coarse long before.
        let pole_max = (F::from_f64(0.5) / period_s).to_f64() as f32;
        within("load_observer_rad_s", self.load_observer_rad_s, 0.1, pole_max)
    }
}
