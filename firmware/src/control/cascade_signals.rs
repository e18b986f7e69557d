//! The signals of every law with a load error, a motor error and an estimate of the gap.

crate::signals! {
    /// Signals of the cascaded laws.
    pub struct CascadeSignals<F> {
        /// Dead-zone amplitude j_hat, as used in this torque.
        dead_zone_estimate_rad: "rad",
        /// Estimated disturbing torque w_hat; zero for a law without compensation.
        disturbing_torque_estimate_nm: "N m",
        /// Load error e_s = theta_s - r.
        load_error_rad: "rad",
        /// Motor error e_e = theta_e - theta_e_d.
        motor_error_rad: "rad",
        /// Elastic torque error e_zeta = K z - zeta_d.
        elastic_error_nm: "N m",
    }
}
