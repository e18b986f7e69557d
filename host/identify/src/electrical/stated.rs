//! What is known of a motor before its motions.

/// What is stated of the motor: by its data sheet, to be within a third of the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated {
    /// Resistance in Ohm.
    pub resistance_ohm: f64,
    /// Inductance in H.
    pub inductance_h: f64,
    /// Torque constant in N m/A.
    pub torque_constant_nm_a: f64,
    /// Largest current in A.
    pub largest_a: f64,
    /// Period of the modulation in s.
    pub pulse_s: f64,
}
