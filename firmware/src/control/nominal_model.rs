//! The nominal mechanics.

crate::parameters! {
    /// Nominal parameters of motor, reducer and load, by default those of table 1 of the paper; the plant may differ.
    pub struct NominalModel<F> {
        /// Motor inertia J_m.
        motor_inertia_kg_m2: F32 = 9.72e-4 in 1e-9..=1e3, "kg m^2";
        /// Viscous friction of the motor f_m.
        motor_friction_nm_s_rad: F32 = 4.3e-4 in 0.0..=1e4, "N m s/rad";
        /// Coulomb friction of the motor F_cM, which the momentum observer subtracts.
        motor_coulomb_nm: F32 = 0.0 in 0.0..=1e3, "N m";
        /// Load inertia J_s.
        load_inertia_kg_m2: F32 = 7.5 in 1e-9..=1e6, "kg m^2";
        /// Viscous friction of the load f_s.
        load_friction_nm_s_rad: F32 = 16.0 in 0.0..=1e6, "N m s/rad";
        /// Reduction ratio N0. The drive's own parameter of this name, so its declaration here must be the same.
        reduction_ratio: F32 = 3.0 in 1e-3..=1e4, "";
        /// Stiffness K of the transmission, seen at the motor.
        stiffness_nm_rad: F32 = 1.0 in 1e-6..=1e9, "N m/rad";
        /// Dead-zone amplitude j0, half the gap; it fixes the steepness gamma = 1 / (2 j0) of equation (5).
        dead_zone_rad: F32 = 0.16 in 1e-6..=10.0, "rad";
    }
}
