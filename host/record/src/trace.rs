//! The columns of a run, one row per control step.
//!
//! | columns, in this order | content |
//! |---|---|
//! | those of [`TraceRow`] | what every run has |
//! | the signals of the plant | its truth at `time_s`; NaN in bench mode, which has no truth |
//! | `drive.NAME` for each signal subscribed | the latest telemetry, repeated until the next; NaN before the first |
//! | `telemetry_time_s` | time of the sample that the drive's signals belong to; NaN before the first telemetry |
//! | `motor_counts`, `load_counts` | the sample as sent, with the faults of the encoders; NaN without one |
//! | `sent_reference_rad` | the reference as sent |
//!
//! They don't depend on the link or on timing, which are in [`timing`](crate::timing).

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{RunStart, Step, StepObserver, TraceRow};
use lashloop_plant::Signal;
use lashloop_plant::metrics::{DRIVE_PREFIX, SignalTable};

use crate::columns::Columns;
use crate::row::{Row, row};

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
        .chain([Signal::new(TELEMETRY_TIME, "s")])
        .chain(sent_columns())
        .collect()
}

pub(crate) fn fixed_columns() -> impl Iterator<Item = Signal> {
    TraceRow::COLUMNS.iter().map(|(name, unit)| Signal::new(name, unit))
}

pub(crate) fn drive_signal(signal: &Signal) -> Signal {
    Signal { name: format!("{DRIVE_PREFIX}{}", signal.name).into(), unit: signal.unit.clone() }
}

/// The columns of the sample as sent.
pub(crate) fn sent_columns() -> impl Iterator<Item = Signal> {
    [("motor_counts", "counts"), ("load_counts", "counts"), ("sent_reference_rad", "rad")]
        .into_iter()
        .map(|(name, unit)| Signal::new(name, unit))
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

#[cfg(test)]
mod tests;
