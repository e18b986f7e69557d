//! `timing.csv`: how each control step went in time. Beside the trace and not in it, because it is another one each time.

use std::path::Path;
use std::time::Duration;

use super::table::TableWriter;
use crate::atomic_file::WriteError;
use crate::timing::{StepOutcome, StepTiming};

/// The header of the file. Times are in microseconds and empty of meaning (NaN) where there was no answer.
pub const COLUMNS: [&str; 8] = [
    "step",
    "lateness_us",
    "answered",
    "missed",
    "send_us",
    "line_and_device_us",
    "compute_us",
    "receive_us",
];

/// Writes the times of steps.
#[derive(Debug)]
pub struct TimingWriter {
    table: TableWriter,
    steps: u64,
}

impl TimingWriter {
    /// As [`TableWriter::create`].
    ///
    /// # Errors
    /// As there.
    pub fn create(path: &Path, flush_rows: u32) -> Result<Self, WriteError> {
        Ok(Self { table: TableWriter::create(path, &COLUMNS, flush_rows)?, steps: 0 })
    }

    /// Takes the next step.
    ///
    /// # Errors
    /// As [`TableWriter::push`].
    pub fn push(&mut self, step: &StepTiming) -> Result<(), WriteError> {
        let flag = |is| f64::from(u8::from(is));
        let part = |part: Option<Duration>| part.map_or(f64::NAN, microseconds);
        let trip = step.round_trip;
        self.table.push(&[
            self.steps as f64,
            microseconds(step.lateness),
            flag(step.outcome == StepOutcome::Answered),
            flag(step.outcome == StepOutcome::Missed),
            part(trip.map(|trip| trip.send)),
            part(trip.map(|trip| trip.line_and_device)),
            part(trip.map(|trip| trip.compute)),
            part(trip.map(|trip| trip.receive)),
        ])?;
        self.steps += 1;
        Ok(())
    }

    /// As [`TableWriter::finish`].
    ///
    /// # Errors
    /// As there.
    pub fn finish(self) -> Result<(), WriteError> {
        self.table.finish()
    }
}

fn microseconds(duration: Duration) -> f64 {
    duration.as_nanos() as f64 / 1e3
}
