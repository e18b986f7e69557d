//! Writes the record of a run while it runs.

use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{RunStart, Step, StepObserver};

use crate::file_names::{MANIFEST_FILE, SCENARIO_FILE, SUMMARY_FILE};
use crate::folder::RecordFolder;
use crate::manifest::Manifest;
use crate::resolved;
use crate::samples::SampleWriter;
use crate::source::RunSource;
use crate::summary::Summary;
use crate::timing::{TimingRow, TimingWriter};
use crate::trace::TraceWriter;

/// Writes a record: what was run before the first step, every step, and the summary at the end. Dropped before the end, it
/// leaves an interrupted record with every step so far.
pub struct RecordWriter {
    folder: RecordFolder,
    source: RunSource,
    /// Created at the start, when the signals are known.
    files: Option<Files>,
}

struct Files {
    samples: SampleWriter,
    trace: TraceWriter,
    timing: TimingWriter,
    flush_rows: u64,
    steps: u64,
}

impl RecordWriter {
    /// Writes to this folder.
    #[must_use]
    pub fn new(folder: RecordFolder, source: RunSource) -> Self {
        Self { folder, source, files: None }
    }

    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Writes what is pending, then the summary.
    ///
    /// # Errors
    /// A file can't be written.
    pub fn finish(self, summary: &Summary, logs: &[String]) -> Result<(), WriteError> {
        if let Some(Files { samples, trace, timing, .. }) = self.files {
            trace.finish()?;
            timing.finish()?;
            let text = serde_json::to_string_pretty(summary).unwrap_or_default();
            samples.finish(&summary.faults, logs, (SUMMARY_FILE, &text))?;
        }
        summary.write(&self.folder.path().join(SUMMARY_FILE))
    }
}

impl StepObserver for RecordWriter {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        let folder = self.folder.path();
        let scenario = start.scenario;
        self.folder.clear()?;
        let manifest = Manifest::new(start, &self.source);
        let resolved = resolved::files(scenario).map_err(|error| WriteError {
            path: folder.join(SCENARIO_FILE),
            action: "written",
            source: std::io::Error::other(error),
        })?;
        resolved::write(folder, &resolved)?;
        let mut attached = vec![(MANIFEST_FILE, manifest.to_json())];
        attached.extend(resolved);
        let flush_rows = scenario.record.flush_rows;
        let period_us = scenario.run.control_period_us;
        self.files = Some(Files {
            samples: SampleWriter::create(folder, start.signals, period_us, &attached)?,
            trace: TraceWriter::create(folder, start.signals, &scenario.encoders, flush_rows)?,
            timing: TimingWriter::create(folder, flush_rows)?,
            flush_rows: flush_rows.into(),
            steps: 0,
        });
        // Last of all: where it is, the folder is a record.
        manifest.write(folder)?;
        // The link is a shortcut. In a folder of all users, such as /tmp, it may belong to another one.
        let _ = self.folder.link_latest();
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        let Some(Files { samples, trace, timing, flush_rows, steps }) = &mut self.files else {
            return Ok(());
        };
        samples.push(step)?;
        trace.push(step)?;
        timing.push(&TimingRow::new(*steps, &step.timing))?;
        *steps += 1;
        if steps.is_multiple_of(*flush_rows) { samples.flush() } else { Ok(()) }
    }
}
