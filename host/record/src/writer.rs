//! Writes the record of a run while it runs.

use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Event, RunError, RunStart, Step, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_plant::metrics::SignalTable;

use crate::columns::Columns;
use crate::failure::Failure;
use crate::file_names::{MANIFEST_FILE, SCENARIO_FILE, SCOPE_FILE, SUMMARY_FILE};
use crate::folder::RecordFolder;
use crate::manifest::Manifest;
use crate::resolved;
use crate::samples::SampleWriter;
use crate::scope;
use crate::source::RunSource;
use crate::summary::Summary;

/// Writes a record: what was run before the first step, every step, and the summary at the end. Dropped before the end, it
/// leaves a record without a summary, with every step so far.
pub struct RecordWriter {
    folder: RecordFolder,
    source: RunSource,
    /// Created at the start, when the signals are known.
    samples: Option<SampleWriter>,
}

impl RecordWriter {
    /// Writes to this folder.
    #[must_use]
    pub fn new(folder: RecordFolder, source: RunSource) -> Self {
        Self { folder, source, samples: None }
    }

    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Removes the files of the record, if the run has begun. An earlier record that it was to replace stays.
    ///
    /// # Errors
    /// A file can't be removed.
    pub fn discard(self) -> Result<(), WriteError> {
        match self.samples {
            Some(samples) => {
                drop(samples);
                self.folder.clear()
            }
            None => Ok(()),
        }
    }

    /// Writes what the drive has captured.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn write_scope(&self, captured: &Columns) -> Result<(), WriteError> {
        scope::write(captured, &self.folder.path().join(SCOPE_FILE))
    }

    /// Writes what is pending, then the summary.
    ///
    /// # Errors
    /// A file can't be written.
    pub fn finish(self, summary: &Summary) -> Result<(), WriteError> {
        match self.samples {
            Some(samples) => finish(samples, &self.folder, summary),
            None => summary.write(&self.folder.path().join(SUMMARY_FILE)),
        }
    }
}

impl StepObserver for RecordWriter {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        let begin = Beginning::new(start, &self.source);
        self.samples = Some(begin.write(&self.folder, 0)?);
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        let pushed = self.samples.as_mut().map_or(Ok(()), |samples| samples.push(step));
        pushed.map_err(|error| self.folder.named(error))
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        if let Some(samples) = &mut self.samples {
            samples.push_event(step, event);
        }
        Ok(())
    }

    fn failed(&mut self, error: &RunError) {
        if self.samples.is_some() {
            // The run's own error counts; on a full disk the record lacks its text.
            let _ = Failure { error: error.to_string() }.write(self.folder.path());
        }
    }
}

/// What a record has before its first step.
pub(crate) struct Beginning {
    manifest: Manifest,
    scenario: Scenario,
    signals: SignalTable,
}

impl Beginning {
    pub(crate) fn new(start: &RunStart<'_>, source: &RunSource) -> Self {
        Self {
            manifest: Manifest::new(start, source),
            scenario: start.scenario.clone(),
            signals: start.signals.clone(),
        }
    }

    /// Replaces what the folder holds, once the head of the samples is written. `first_step` is the number of the first
    /// step to come.
    pub(crate) fn write(&self, folder: &RecordFolder, first_step: u64) -> Result<SampleWriter, WriteError> {
        let samples = folder.begin(|path| self.write_files(path, first_step))?;
        // The link is a shortcut. In a folder of all users, such as /tmp, it may belong to another one.
        let _ = folder.link_latest();
        Ok(samples)
    }

    fn write_files(&self, path: &Path, first_step: u64) -> Result<SampleWriter, WriteError> {
        let Self { manifest, scenario, signals } = self;
        let resolved = resolved::files(scenario).map_err(|error| WriteError {
            path: path.join(SCENARIO_FILE),
            action: "written",
            source: std::io::Error::other(error),
        })?;
        resolved::write(path, &resolved)?;
        let mut attached = vec![(MANIFEST_FILE, manifest.to_json())];
        attached.extend(resolved);
        let (times, flush_rows) = (manifest.step_times(), scenario.record.flush_rows.into());
        let samples = SampleWriter::create(path, signals, times, first_step, flush_rows, &attached)?;
        manifest.write(path)?;
        Ok(samples)
    }
}

/// Writes what is pending, then the summary.
pub(crate) fn finish(
    samples: SampleWriter,
    folder: &RecordFolder,
    summary: &Summary,
) -> Result<(), WriteError> {
    let text = serde_json::to_string_pretty(summary).unwrap_or_default();
    samples.finish((SUMMARY_FILE, &text)).map_err(|error| folder.named(error))?;
    summary.write(&folder.path().join(SUMMARY_FILE))
}
