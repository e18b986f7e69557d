//! The motor as the drive believes it to be.

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
