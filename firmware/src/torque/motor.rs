//! The motor as the drive believes it to be.

use crate::law::Real;

/// What the drive believes of its motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Resistance R of the armature, with that of the bridge, in Ohm.
    pub resistance_ohm: f32,
    /// Inductance L of the armature in H.
    pub inductance_h: f32,
    /// Torque constant k_t in N m/A, and constant of the back-EMF in V s/rad.
    pub torque_constant_nm_a: f32,
}

impl Motor {
    /// The part of a step of the voltage that the current has followed after a time in s: 1 - e^(-R t/L).
    pub(super) fn settled_in(&self, time_s: f32) -> f32 {
        -Real::exp_m1(-self.resistance_ohm * time_s / self.inductance_h)
    }
}
