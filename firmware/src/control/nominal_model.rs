//! The nominal mechanics.

use crate::control::Real;

/// Nominal parameters of motor, reducer and load; the plant may differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NominalModel<F> {
    /// Motor inertia J_m in kg m^2.
    pub motor_inertia_kg_m2: F,
    /// Viscous friction of the motor f_m in N m s/rad.
    pub motor_friction_nm_s_rad: F,
    /// Load inertia J_s in kg m^2.
    pub load_inertia_kg_m2: F,
    /// Viscous friction of the load f_s in N m s/rad.
    pub load_friction_nm_s_rad: F,
    /// Reduction ratio N0.
    pub ratio: F,
    /// Stiffness K of the transmission in N m/rad, seen at the motor.
    pub stiffness_nm_rad: F,
    /// Dead-zone amplitude j0 in rad, half the gap; it fixes the steepness gamma = 1 / (2 j0) of equation (5).
    pub dead_zone_rad: F,
    /// Coulomb friction of the motor F_cM in N m, which the momentum observer subtracts.
    pub motor_coulomb_nm: F,
}

impl<F: Real> NominalModel<F> {
    /// Table 1 of the paper.
    pub fn paper() -> Self {
        Self {
            motor_inertia_kg_m2: F::from_f64(9.72e-4),
            motor_friction_nm_s_rad: F::from_f64(4.3e-4),
            load_inertia_kg_m2: F::from_f64(7.5),
            load_friction_nm_s_rad: F::from_f64(16.0),
            ratio: F::from_f64(3.0),
            stiffness_nm_rad: F::from_f64(1.0),
            dead_zone_rad: F::from_f64(0.16),
            motor_coulomb_nm: F::ZERO,
        }
    }
}
