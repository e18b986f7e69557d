//! The signals of the law.

crate::signals! {
    /// The signals of the cascaded laws, and the standard deviation of the gap.
    pub struct BrakingCurveSignals<F> {
        /// Dead-zone amplitude j_hat, as used in this torque.
        dead_zone_estimate_rad: "rad",
        /// Estimated disturbing torque w_hat.
        disturbing_torque_estimate_nm: "N m",
        /// Load error e_s = theta_s - r.
        load_error_rad: "rad",
        /// Twist minus its command.
        motor_error_rad: "rad",
        /// Elastic torque minus its command.
        elastic_error_nm: "N m",
        /// Standard deviation of `dead_zone_estimate_rad`, at every time.
        dead_zone_deviation_rad: "rad",
    }
}
