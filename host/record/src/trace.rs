//! `trace.csv`: the plant's true state, the torque and the drive's signals, one row per control step.
//!
//! | columns, in this order | content |
//! |---|---|
//! | those of [`TraceRow`] | what every run has |
//! | the signals of the plant | its truth at `time_s`; NaN in bench mode, which has no truth |
//! | `drive.NAME` for each signal subscribed | the latest telemetry, repeated until the next; NaN before the first |
//! | `telemetry_time_s` | time of the sample that the drive's signals belong to; NaN before the first telemetry |
//!
//! `trace.json` lists the columns with their units. The trace doesn't depend on the link or on timing, which are in
//! [`timing`](crate::timing).

use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

use lashloop_bench::run::{Step, TraceRow};
use lashloop_plant::Signal;
use lashloop_plant::metrics::{DRIVE_PREFIX, SignalTable};
use serde::Serialize;

use crate::file_names::{COLUMNS_FILE, TRACE_FILE};
use crate::row::{Row, row};
use crate::table::TableWriter;
use lashloop_bench::atomic_file::{WriteError, write_whole};

row! {
    TraceRow {
        time_s: "s",
        reference_rad: "rad",
        load_position_rad: "rad",
        motor_position_rad: "rad",
        torque_nm: "N m",
    }
}

/// Name of the last column.
pub const TELEMETRY_TIME: &str = "telemetry_time_s";

/// Name and unit of each column of a run with these signals.
#[must_use]
pub fn columns(signals: &SignalTable) -> Vec<Signal> {
    let fixed = TraceRow::COLUMNS.iter().map(|(name, unit)| named(*name, *unit));
    let drive = signals.drive.iter().map(|it| named(format!("{DRIVE_PREFIX}{}", it.name), it.unit.clone()));
    fixed.chain(signals.plant.iter().cloned()).chain(drive).chain([named(TELEMETRY_TIME, "s")]).collect()
}

fn named(name: impl Into<Cow<'static, str>>, unit: impl Into<Cow<'static, str>>) -> Signal {
    Signal { name: name.into(), unit: unit.into() }
}

/// The row of a step, in the order of [`columns`].
pub fn row(step: &Step) -> impl Iterator<Item = f64> {
    let telemetry_time_s = step.drive.time_s.unwrap_or(f64::NAN);
    let signals = step.plant.iter().chain(&step.drive.values).copied();
    step.row.values().chain(signals).chain([telemetry_time_s])
}

/// Writes a trace and the list of its columns.
#[derive(Debug)]
pub struct TraceWriter(TableWriter);

impl TraceWriter {
    /// Creates `trace.json` and `trace.csv` in `folder`, in place of older ones. `flush_rows` is the number of rows per
    /// chunk.
    ///
    /// # Errors
    /// A file can't be created or written.
    pub fn create(folder: &Path, signals: &SignalTable, flush_rows: u32) -> Result<Self, WriteError> {
        let columns = columns(signals);
        write_whole(&folder.join(COLUMNS_FILE), ".columns-", |file| {
            serde_json::to_writer_pretty(&mut *file, &ColumnList { columns: &columns })?;
            file.write_all(b"\n")
        })?;
        let header = columns.iter().map(|column| &*column.name);
        TableWriter::create(&folder.join(TRACE_FILE), header, flush_rows).map(Self)
    }

    /// Appends a row: the values of [`columns`].
    ///
    /// # Errors
    /// As [`TableWriter::push`].
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) -> Result<(), WriteError> {
        self.0.push(row)
    }

    /// Writes the pending rows.
    ///
    /// # Errors
    /// The rows can't be written.
    pub fn finish(self) -> Result<(), WriteError> {
        self.0.finish()
    }
}

/// The content of `trace.json`.
#[derive(Debug, Serialize)]
struct ColumnList<'a> {
    columns: &'a [Signal],
}

#[cfg(test)]
mod tests;
