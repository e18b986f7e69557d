//! Cogging: the torque between the magnets of the motor and the teeth of its stator, without current.

use super::parameters::CoggingParameters;

/// A sin(n theta_e), the torque of the potential (A / n) (1 + cos(n theta_e)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cogging {
    amplitude_nm: f64,
    per_turn: f64,
}

impl Cogging {
    pub(super) fn new(CoggingParameters { amplitude_nm, per_turn }: CoggingParameters) -> Self {
        Self { amplitude_nm, per_turn }
    }

    /// Torque on the motor in N m.
    #[inline(always)]
    pub(super) fn torque_nm(&self, motor_position_rad: f64) -> f64 {
        if self.amplitude_nm == 0.0 {
            return 0.0;
        }
        self.amplitude_nm * libm::sin(self.per_turn * motor_position_rad)
    }

    /// Energy in the field in J, 0 where it is least.
    pub(super) fn energy_j(&self, motor_position_rad: f64) -> f64 {
        self.amplitude_nm / self.per_turn * (1.0 + libm::cos(self.per_turn * motor_position_rad))
    }

    /// Largest stiffness in N m/rad.
    pub(super) fn stiffness_nm_rad(&self) -> f64 {
        self.amplitude_nm * self.per_turn
    }
}
