//! `timing.csv`: timing of each control step. Apart from the trace, because timing differs from run to run.

use std::path::Path;
use std::time::Duration;

use super::file_names::TIMING_FILE;
use super::row::{Row, row};
use super::table::TableWriter;
use crate::atomic_file::WriteError;
use crate::timing::{StepOutcome, StepTiming};

row! {
    /// One control step. The parts of the round trip are NaN in a step without an answer.
    pub struct TimingRow {
        /// Control step, from 0.
        step: "",
        /// Wake-up of the bench after its deadline; in bench mode, start of the drive's step after its due time.
        lateness_us: "us",
        /// 1 if the drive has answered in time, else 0.
        answered: "",
        /// 1 if the step was missed and no sample sent, else 0.
        missed: "",
        /// Sending the sample.
        send_us: "us",
        /// From the end of sending to the arrival of the answer, less the drive's computing time.
        line_and_device_us: "us",
        /// The drive's computing time, in device time.
        compute_us: "us",
        /// Receiving the answer.
        receive_us: "us",
    }
}

impl TimingRow {
    /// The row of a step, counted from 0.
    #[must_use]
    pub fn new(step: u64, timing: &StepTiming) -> Self {
        let flag = |is| f64::from(u8::from(is));
        let part = |part: Option<Duration>| part.map_or(f64::NAN, microseconds);
        let trip = timing.round_trip;
        Self {
            step: step as f64,
            lateness_us: microseconds(timing.lateness),
            answered: flag(timing.outcome == StepOutcome::Answered),
            missed: flag(timing.outcome == StepOutcome::Missed),
            send_us: part(trip.map(|trip| trip.send)),
            line_and_device_us: part(trip.map(|trip| trip.line_and_device)),
            compute_us: part(trip.map(|trip| trip.compute).or(timing.tick_compute)),
            receive_us: part(trip.map(|trip| trip.receive)),
        }
    }
}

/// Writes the timing of steps.
#[derive(Debug)]
pub struct TimingWriter(TableWriter);

impl TimingWriter {
    /// Creates `timing.csv` in `folder`, in place of an older one. `flush_rows` is the number of rows per chunk.
    ///
    /// # Errors
    /// The file can't be created or written.
    pub fn create(folder: &Path, flush_rows: u32) -> Result<Self, WriteError> {
        let header = TimingRow::COLUMNS.iter().map(|(name, _)| *name);
        TableWriter::create(&folder.join(TIMING_FILE), header, flush_rows).map(Self)
    }

    /// Appends a row.
    ///
    /// # Errors
    /// As [`TableWriter::push`].
    pub fn push(&mut self, row: &TimingRow) -> Result<(), WriteError> {
        self.0.push(row.values())
    }

    /// Writes the pending rows.
    ///
    /// # Errors
    /// The rows can't be written.
    pub fn finish(self) -> Result<(), WriteError> {
        self.0.finish()
    }
}

fn microseconds(duration: Duration) -> f64 {
    duration.as_nanos() as f64 / 1e3
}
