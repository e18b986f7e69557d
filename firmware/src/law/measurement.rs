//! Input and output of a control law.

use super::real::Real;

/// One sample as the drive measures it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement<F> {
    /// Motor position theta_e in rad.
    pub motor_position_rad: F,
    /// Motor velocity in rad/s.
    pub motor_velocity_rad_s: F,
    /// Load position theta_s in rad.
    pub load_position_rad: F,
    /// Load velocity in rad/s.
    pub load_velocity_rad_s: F,
    /// Twist z = theta_e - N0 theta_s in rad. A field of its own: in single precision the difference of two large
    /// positions loses the digits that the difference of their counts keeps.
    pub twist_rad: F,
    /// Reference r of the load position in rad.
    pub reference_position_rad: F,
    /// Velocity of the reference in rad/s.
    pub reference_velocity_rad_s: F,
    /// Acceleration of the reference in rad/s^2.
    pub reference_acceleration_rad_s2: F,
    /// Torque applied since the previous sample in N m, after the drive's limit.
    pub applied_torque_nm: F,
}

impl<F: Real> Default for Measurement<F> {
    /// Motor, load and reference at rest at zero, and no torque.
    fn default() -> Self {
        Self {
            motor_position_rad: F::ZERO,
            motor_velocity_rad_s: F::ZERO,
            load_position_rad: F::ZERO,
            load_velocity_rad_s: F::ZERO,
            twist_rad: F::ZERO,
            reference_position_rad: F::ZERO,
            reference_velocity_rad_s: F::ZERO,
            reference_acceleration_rad_s2: F::ZERO,
            applied_torque_nm: F::ZERO,
        }
    }
}

/// Output of a control law for one [`Measurement`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlOutput<S, F = f32> {
    /// Motor torque U in N m, before the drive's limit.
    pub torque_nm: F,
    /// Signals of the law for the host; they belong to this torque.
    pub signals: S,
}
