//! What a user states of the machine and of the task, besides the mechanics.

crate::parameters! {
    /// The tuning of the law. Every gain follows from it and from the machine, see [`Gains`](super::Gains).
    pub struct BrakingCurveTuning<F> {
        /// Speed of all loops relative to that of the synthesis. Less is calmer on a load that bends; more is faster and wears more.
        pace: F32 = 1.0 in 0.1..=2.0, "";
        /// Largest commanded load velocity relative to the reference; torque and `motor_speed_limit_rad_s` limit it too.
        top_speed_rad_s: F32 = 100.0 in 0.0..=1e6, "rad/s";
        /// Load error of arrival.
        landing_band_rad: F32 = 0.002 in 0.0..=1.0, "rad";
        /// Nominal dry friction of the load, fed forward in motion.
        load_coulomb_nm: F32 = 3.4 in 0.0..=1e6, "N m";
        /// Time from a command to its torque: delay and lag of the drive's torque.
        torque_lag_s: F32 = 0.0015 in 0.0..=1.0, "s";
    }
}
