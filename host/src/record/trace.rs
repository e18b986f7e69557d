//! `trace.csv`: the truth of the plant and the torque, one row per control step.
//!
//! Numbers are the shortest that read back to the same bits. Rows are collected and handed to the file
//! `flush_rows` at a time, each time whole, so that a run that is cut off leaves a table and not a torn line.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::RecordError;

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
}

impl TraceRow {
    /// The header of the file.
    pub const COLUMNS: [&str; 22] = [
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
        ]
    }
}

/// Writes a trace. [`finish`](Self::finish) reports whether the last rows arrived; a writer that is merely
/// dropped writes them too, but has nobody to tell.
#[derive(Debug)]
pub struct TraceWriter {
    path: PathBuf,
    file: File,
    flush_rows: u32,
    pending: Vec<u8>,
    pending_rows: u32,
    /// Bytes of whole rows in the file.
    written: u64,
}

impl TraceWriter {
    /// Creates the file, or empties it, and writes the header. `flush_rows` is the number of rows that reach
    /// the file together; 0 counts as 1.
    ///
    /// # Errors
    /// The file can't be created or the header can't be written.
    pub fn create(path: &Path, flush_rows: u32) -> Result<Self, RecordError> {
        let file = File::create(path).map_err(|source| RecordError {
            path: path.to_owned(),
            action: "created",
            source,
        })?;
        let mut pending = TraceRow::COLUMNS.join(",").into_bytes();
        pending.push(b'\n');
        let path = path.to_owned();
        let mut writer = Self { path, file, flush_rows, pending, pending_rows: 0, written: 0 };
        writer.flush()?;
        Ok(writer)
    }

    /// Takes the next row.
    ///
    /// # Errors
    /// It was time to write and the file can't take the rows; they are lost, those before are kept.
    pub fn push(&mut self, row: &TraceRow) -> Result<(), RecordError> {
        let mut number = zmij::Buffer::new();
        for value in row.values() {
            self.pending.extend_from_slice(number.format(value).as_bytes());
            self.pending.push(b',');
        }
        // The last column ends the line.
        if let Some(last) = self.pending.last_mut() {
            *last = b'\n';
        }
        self.pending_rows += 1;
        if self.pending_rows < self.flush_rows { Ok(()) } else { self.flush() }
    }

    /// Writes the rows that are still pending.
    ///
    /// # Errors
    /// The file can't take them.
    pub fn finish(mut self) -> Result<(), RecordError> {
        self.flush()
    }

    fn flush(&mut self) -> Result<(), RecordError> {
        let result = self.file.write_all(&self.pending);
        if result.is_ok() {
            self.written += self.pending.len() as u64;
        } else {
            // A full disk may have taken part of a row. If this fails as well, the first error says enough.
            let _ = self.file.set_len(self.written);
            let _ = self.file.seek(SeekFrom::Start(self.written));
        }
        self.pending.clear();
        self.pending_rows = 0;
        result.map_err(|source| RecordError { path: self.path.clone(), action: "written", source })
    }
}

impl Drop for TraceWriter {
    fn drop(&mut self) {
        // Nobody is left to tell; `finish` is there for whoever wants to know.
        let _ = self.flush();
    }
}

#[cfg(test)]
mod tests;
