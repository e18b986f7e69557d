//! `trace.csv`: the plant's true state and the torque, one row per control step.
//!
//! The trace doesn't depend on the link or on timing, which are in [`timing`](super::timing).

use super::row::row;
use super::table::TableWriter;

row! {
    /// One control step. Positions, velocities and torques are the true ones at `time_s`, unless the column is an estimate.
    pub struct TraceRow {
        /// Time of the run.
        time_s,
        /// Commanded load position.
        reference_rad,
        /// Load position theta_s.
        load_position_rad,
        /// Load velocity.
        load_velocity_rad_s,
        /// Motor position theta_e.
        motor_position_rad,
        /// Motor velocity.
        motor_velocity_rad_s,
        /// Torque U, held from `time_s` on.
        torque_nm,
        /// Torque C through gap and spring.
        transmitted_torque_nm,
        /// Motor position minus reduced load position, z.
        twist_rad,
        /// The drive's estimate of the half gap j0.
        dead_zone_estimate_rad,
        /// Half gap j0.
        dead_zone_rad,
        /// Position in the gap, theta_b.
        gap_position_rad,
        /// Side in contact: -1, 0 or 1.
        contact,
        /// Motor torque after delay, saturation and lag; at a jump, the torque before it.
        motor_torque_nm,
        /// External torque on the load.
        load_torque_nm,
        /// Dry friction on the load, positive against positive motion.
        load_dry_friction_nm,
        /// Dry friction on the motor, positive against positive motion.
        motor_dry_friction_nm,
        /// 1 while the load sticks, else 0.
        load_sticks,
        /// 1 while the motor sticks, else 0.
        motor_sticks,
        /// Energy stored in masses, spring and bristles.
        stored_energy_j,
        /// Energy supplied by motor and load torque since the start: stored plus dissipated energy, less the energy stored at
        /// the start.
        supplied_energy_j,
        /// Energy dissipated by friction and damping since the start.
        dissipated_energy_j,
        /// Disturbing torque w = C - K z.
        disturbing_torque_nm,
        /// The drive's estimate of w.
        disturbing_torque_estimate_nm,
        /// Motor position minus the one that the load loop commands, from the drive's telemetry.
        motor_error_rad,
        /// Time of the sample that estimates and motor error belong to. Telemetry arrives every n-th step, and the last one is
        /// repeated until the next.
        estimate_time_s,
    }
}

/// Writes a trace.
pub type TraceWriter = TableWriter<TraceRow>;

#[cfg(test)]
mod tests;
