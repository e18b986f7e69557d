//! `trace.csv`: the truth of the plant and the torque, one row per control step.
//!
//! What it tells does not depend on what carried the bytes or on how long that took: see [`timing`](super::timing) for that.

use std::path::Path;

use super::table::TableWriter;
use crate::atomic_file::WriteError;

/// Everything a trace tells about one control step; positions and velocities are those at `time_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TraceRow {
    /// Time of the run.
    pub time_s: f64,
    /// Load position asked for.
    pub reference_rad: f64,
    /// True load position, theta_s.
    pub load_position_rad: f64,
    /// True load velocity.
    pub load_velocity_rad_s: f64,
    /// True motor position, theta_e.
    pub motor_position_rad: f64,
    /// True motor velocity.
    pub motor_velocity_rad_s: f64,
    /// Torque held from `time_s` on, U.
    pub torque_nm: f64,
    /// Torque through gap and spring, C.
    pub transmitted_torque_nm: f64,
    /// Motor position less reduced load position, z.
    pub twist_rad: f64,
    /// The drive's estimate of j0.
    pub dead_zone_estimate_rad: f64,
    /// True j0.
    pub dead_zone_rad: f64,
    /// Position in the gap, theta_b.
    pub gap_position_rad: f64,
    /// Side in contact: -1, 0 or 1.
    pub contact: f64,
    /// Torque at the motor after delay, saturation and lag; where it jumps at `time_s`, the one before the jump.
    pub motor_torque_nm: f64,
    /// Torque on the load from outside.
    pub load_torque_nm: f64,
    /// Dry friction on the load, against positive motion.
    pub load_dry_friction_nm: f64,
    /// Dry friction on the motor, against positive motion.
    pub motor_dry_friction_nm: f64,
    /// 1 while the load sticks, else 0.
    pub load_sticks: f64,
    /// 1 while the motor sticks, else 0.
    pub motor_sticks: f64,
    /// Energy in masses, spring and bristles.
    pub stored_energy_j: f64,
    /// Energy put in by motor and load torque since the start. Stored energy changes by this less the next.
    pub supplied_energy_j: f64,
    /// Energy lost to friction and damping since the start.
    pub dissipated_energy_j: f64,
    /// True disturbing torque, w = C - K z.
    pub disturbing_torque_nm: f64,
    /// The drive's estimate of w.
    pub disturbing_torque_estimate_nm: f64,
    /// Motor position less the one the load loop asks for, as the drive tells it.
    pub motor_error_rad: f64,
    /// Time of the sample that this row's estimates and motor error are of: telemetry comes every n-th step, and the last
    /// is shown until the next.
    pub estimate_time_s: f64,
}

impl TraceRow {
    /// The header of the file.
    pub const COLUMNS: [&str; 26] = [
        "time_s",
        "reference_rad",
        "load_position_rad",
        "load_velocity_rad_s",
        "motor_position_rad",
        "motor_velocity_rad_s",
        "torque_nm",
        "transmitted_torque_nm",
        "twist_rad",
        "dead_zone_estimate_rad",
        "dead_zone_rad",
        "gap_position_rad",
        "contact",
        "motor_torque_nm",
        "load_torque_nm",
        "load_dry_friction_nm",
        "motor_dry_friction_nm",
        "load_sticks",
        "motor_sticks",
        "stored_energy_j",
        "supplied_energy_j",
        "dissipated_energy_j",
        "disturbing_torque_nm",
        "disturbing_torque_estimate_nm",
        "motor_error_rad",
        "estimate_time_s",
    ];

    /// The values in the order of [`COLUMNS`](Self::COLUMNS).
    #[must_use]
    pub const fn values(&self) -> [f64; Self::COLUMNS.len()] {
        [
            self.time_s,
            self.reference_rad,
            self.load_position_rad,
            self.load_velocity_rad_s,
            self.motor_position_rad,
            self.motor_velocity_rad_s,
            self.torque_nm,
            self.transmitted_torque_nm,
            self.twist_rad,
            self.dead_zone_estimate_rad,
            self.dead_zone_rad,
            self.gap_position_rad,
            self.contact,
            self.motor_torque_nm,
            self.load_torque_nm,
            self.load_dry_friction_nm,
            self.motor_dry_friction_nm,
            self.load_sticks,
            self.motor_sticks,
            self.stored_energy_j,
            self.supplied_energy_j,
            self.dissipated_energy_j,
            self.disturbing_torque_nm,
            self.disturbing_torque_estimate_nm,
            self.motor_error_rad,
            self.estimate_time_s,
        ]
    }
}

/// Writes a trace.
#[derive(Debug)]
pub struct TraceWriter(TableWriter);

impl TraceWriter {
    /// As [`TableWriter::create`].
    ///
    /// # Errors
    /// As there.
    pub fn create(path: &Path, flush_rows: u32) -> Result<Self, WriteError> {
        Ok(Self(TableWriter::create(path, &TraceRow::COLUMNS, flush_rows)?))
    }

    /// As [`TableWriter::push`].
    ///
    /// # Errors
    /// As there.
    pub fn push(&mut self, row: &TraceRow) -> Result<(), WriteError> {
        self.0.push(&row.values())
    }

    /// As [`TableWriter::finish`].
    ///
    /// # Errors
    /// As there.
    pub fn finish(self) -> Result<(), WriteError> {
        self.0.finish()
    }
}

#[cfg(test)]
mod tests;
