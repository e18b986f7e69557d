//! The signals of the drive itself, which exist under every law.

crate::signals! {
    /// The signals of the drive itself. The velocities are behind the drive's filters, so they are what the law has.
    pub struct DriveSignals {
        /// Torque of the law before the torque limit.
        requested_torque_nm: "N m",
        /// Motor velocity behind its filter.
        measured_motor_velocity_rad_s: "rad/s",
        /// Load velocity behind its filter.
        measured_load_velocity_rad_s: "rad/s",
        /// Twist from the counts of both encoders.
        measured_twist_rad: "rad",
        /// Torque since the last step: by the measured current, else the held one.
        measured_torque_nm: "N m",
        /// Mean voltage of the bridge since the last step; 0 where no measured current makes the torque.
        bridge_voltage_v: "V",
    }
}
