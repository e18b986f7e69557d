//! The columns of a run, and `trace.csv`: what bench and drive have exchanged, one row per control step.
//!
//! | columns of a run, in this order | content | in `trace.csv` |
//! |---|---|---|
//! | those of [`TraceRow`] | what every run has | yes |
//! | the signals of the plant | its truth at `time_s`; NaN in bench mode, which has no truth | no |
//! | `drive.NAME` for each signal subscribed | the latest telemetry, repeated until the next; NaN before the first | new ones |
//! | `telemetry_time_s` | time of the sample that the drive's signals belong to; NaN before the first telemetry | new ones |
//! | `motor_counts`, `load_counts` | the sample as sent, with the faults of the encoders; NaN without one | yes |
//! | `sent_reference_rad` | the reference as sent | no |
//!
//! `trace.csv` is for spreadsheets: an empty field stands for NaN and for telemetry that came before. Its numbers are rounded
//! to an eighth of an encoder count, and to 4 significant digits in units other than rad. [`samples`](crate::samples) have
//! every column and every bit. `trace.json` lists the columns of `trace.csv` with their units. The trace doesn't depend on the
//! link or on timing, which are in [`timing`](crate::timing).

use std::borrow::Cow;
use std::f64::consts::TAU;
use std::io::Write;
use std::path::Path;

use lashloop_bench::atomic_file::{WriteError, write_whole};
use lashloop_bench::run::{RunStart, Step, StepObserver, TraceRow};
use lashloop_bench::scenario::sections::EncoderSettings;
use lashloop_plant::Signal;
use lashloop_plant::metrics::{DRIVE_PREFIX, SignalTable};
use serde::Serialize;

use crate::columns::Columns;
use crate::digits::Digits;
use crate::file_names::{COLUMNS_FILE, TRACE_FILE};
use crate::row::{Row, row};
use crate::table::TableWriter;

row! {
    TraceRow {
        time_s: "s",
        reference_rad: "rad",
        load_position_rad: "rad",
        motor_position_rad: "rad",
        torque_nm: "N m",
    }
}

/// Name of the first column.
pub const TIME: &str = "time_s";
/// Name of the column after the drive's signals.
pub const TELEMETRY_TIME: &str = "telemetry_time_s";

/// Name and unit of each column of a run with these signals.
#[must_use]
pub fn columns(signals: &SignalTable) -> Vec<Signal> {
    let plant = signals.plant.iter().cloned();
    let drive = signals.drive.iter().map(drive_signal);
    fixed_columns()
        .chain(plant)
        .chain(drive)
        .chain([named(TELEMETRY_TIME, "s")])
        .chain(sent_columns())
        .collect()
}

pub(crate) fn fixed_columns() -> impl Iterator<Item = Signal> {
    TraceRow::COLUMNS.iter().map(|(name, unit)| named(*name, *unit))
}

pub(crate) fn drive_signal(signal: &Signal) -> Signal {
    named(format!("{DRIVE_PREFIX}{}", signal.name), signal.unit.clone())
}

/// The columns of the sample as sent.
pub(crate) fn sent_columns() -> impl Iterator<Item = Signal> {
    [("motor_counts", "counts"), ("load_counts", "counts"), ("sent_reference_rad", "rad")]
        .into_iter()
        .map(|(name, unit)| named(name, unit))
}

fn named(name: impl Into<Cow<'static, str>>, unit: impl Into<Cow<'static, str>>) -> Signal {
    Signal { name: name.into(), unit: unit.into() }
}

/// The row of a step, in the order of [`columns`].
pub fn row(step: &Step) -> impl Iterator<Item = f64> {
    let telemetry_time_s = step.drive.time_s.unwrap_or(f64::NAN);
    let signals = step.plant.iter().chain(&step.drive.values).copied();
    step.row.values().chain(signals).chain([telemetry_time_s]).chain(sent_values(step))
}

pub(crate) fn sent_values(step: &Step) -> [f64; 3] {
    step.sample.map_or([f64::NAN; 3], |sample| {
        [sample.motor_counts.get().into(), sample.load_counts.get().into(), sample.reference_rad.into()]
    })
}

/// Keeps every step of a run in memory.
impl StepObserver for Columns {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        *self = Self::new(columns(start.signals));
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.push(row(step));
        Ok(())
    }
}

/// Writes a trace and the list of its columns.
#[derive(Debug)]
pub struct TraceWriter {
    table: TableWriter,
    /// Time of the last telemetry written.
    telemetry_time_s: Option<f64>,
}

impl TraceWriter {
    /// Creates `trace.json` and `trace.csv` in `folder`, in place of older ones. `flush_rows` is the number of rows per
    /// chunk.
    ///
    /// # Errors
    /// A file can't be created or written.
    pub fn create(
        folder: &Path,
        signals: &SignalTable,
        encoders: &EncoderSettings,
        flush_rows: u32,
    ) -> Result<Self, WriteError> {
        let mut columns = columns(&SignalTable { plant: Vec::new(), drive: signals.drive.clone() });
        // The last one differs from the reference by rounding only.
        columns.pop();
        write_whole(&folder.join(COLUMNS_FILE), ".columns-", |file| {
            serde_json::to_writer_pretty(&mut *file, &ColumnList { columns: &columns })?;
            file.write_all(b"\n")
        })?;
        let position_decimals = position_decimals(encoders);
        let header = columns.iter().map(|column| (&*column.name, digits(column, position_decimals)));
        let table = TableWriter::create(&folder.join(TRACE_FILE), header, flush_rows)?;
        Ok(Self { table, telemetry_time_s: None })
    }

    /// Appends a step.
    ///
    /// # Errors
    /// As [`TableWriter::push`].
    pub fn push(&mut self, step: &Step) -> Result<(), WriteError> {
        let is_new = step.drive.time_s != self.telemetry_time_s;
        self.telemetry_time_s = step.drive.time_s;
        let telemetry = step.drive.values.iter().copied().chain([step.drive.time_s.unwrap_or(f64::NAN)]);
        let telemetry = telemetry.map(|value| if is_new { value } else { f64::NAN });
        self.table.push(step.row.values().chain(telemetry).chain(sent_values(step)))
    }

    /// Writes the pending rows.
    ///
    /// # Errors
    /// The rows can't be written.
    pub fn finish(self) -> Result<(), WriteError> {
        self.table.finish()
    }
}

/// Decimals of a position in rad, rounded to an eighth of a count of the finer encoder.
fn position_decimals(encoders: &EncoderSettings) -> u8 {
    let counts_per_rev = encoders.motor_counts_per_rev.max(encoders.load_counts_per_rev);
    let count_rad = TAU / f64::from(counts_per_rev);
    (4.0 / count_rad).log10().ceil().clamp(0.0, 9.0) as u8
}

fn digits(column: &Signal, position_decimals: u8) -> Digits {
    match &*column.unit {
        // The control period is whole microseconds.
        "s" => Digits::Decimals(6),
        "rad" => Digits::Decimals(position_decimals),
        "counts" => Digits::Decimals(0),
        _ => Digits::Significant(4),
    }
}

/// The content of `trace.json`.
#[derive(Debug, Serialize)]
struct ColumnList<'a> {
    columns: &'a [Signal],
}

#[cfg(test)]
mod tests;
