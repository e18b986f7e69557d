//! The mechanics the laws believe in.

use crate::control::parameter::{Limits, all_within};
use crate::control::{ParameterError, Real};

const LIMITS: [Limits; 8] = [
    ("motor_inertia_kg_m2", 1e-9, 1e3),
    ("motor_friction_nm_s_rad", 0.0, 1e4),
    ("load_inertia_kg_m2", 1e-9, 1e6),
    ("load_friction_nm_s_rad", 0.0, 1e6),
    ("ratio", 1e-3, 1e4),
    ("stiffness_nm_rad", 1e-6, 1e9),
    ("dead_zone_rad", 1e-6, 10.0),
    ("motor_coulomb_nm", 0.0, 1e3),
];

/// Nominal parameters of motor, reducer and load; the true plant may differ.
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
    /// Coulomb friction of the motor F_cM in N m, which the momentum observer takes off.
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

    /// Checks every parameter.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        all_within(
            &LIMITS,
            [
                self.motor_inertia_kg_m2,
                self.motor_friction_nm_s_rad,
                self.load_inertia_kg_m2,
                self.load_friction_nm_s_rad,
                self.ratio,
                self.stiffness_nm_rad,
                self.dead_zone_rad,
                self.motor_coulomb_nm,
            ],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_dead_zone_of_nothing_is_refused_by_name() {
        let model = NominalModel { dead_zone_rad: 0.0_f32, ..NominalModel::paper() };
        let error = model.validate().expect_err("gamma would be infinite");
        assert_eq!(error.to_string(), "control parameter dead_zone_rad is 0, allowed is 0.000001 to 10");
        assert!(NominalModel { ratio: f32::NAN, ..NominalModel::paper() }.validate().is_err());
    }
}
