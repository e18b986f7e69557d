//! The record of a case while it runs.

use std::path::PathBuf;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{RunStart, Step, StepObserver};
use lashloop_record::summary::{SUMMARY_FILE, Summary};
use lashloop_record::timing::{TimingRow, TimingWriter};
use lashloop_record::trace::{self, TraceWriter};

/// Writes a record into a folder.
pub struct CaseRecord {
    folder: PathBuf,
    tables: Option<(TraceWriter, TimingWriter)>,
    steps: u64,
}

impl CaseRecord {
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, tables: None, steps: 0 }
    }

    /// Writes what is pending and the summary.
    ///
    /// # Errors
    /// A file can't be written.
    pub fn finish(self, summary: &Summary) -> Result<(), WriteError> {
        if let Some((trace, timing)) = self.tables {
            trace.finish()?;
            timing.finish()?;
        }
        summary.write(&self.folder.join(SUMMARY_FILE))
    }
}

impl StepObserver for CaseRecord {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        let flush_rows = start.scenario.record.flush_rows;
        self.tables = Some((
            TraceWriter::create(&self.folder, start.signals, flush_rows)?,
            TimingWriter::create(&self.folder, flush_rows)?,
        ));
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        let Some((trace, timing)) = &mut self.tables else { return Ok(()) };
        trace.push(trace::row(step))?;
        timing.push(&TimingRow::new(self.steps, &step.timing))?;
        self.steps += 1;
        Ok(())
    }
}
