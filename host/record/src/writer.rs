//! Writes the record of a run while it runs.

use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Event, RunError, RunStart, Step, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_plant::metrics::SignalTable;

use crate::failure::Failure;
use crate::file_names::{MANIFEST_FILE, SCENARIO_FILE, SUMMARY_FILE};
use crate::folder::RecordFolder;
use crate::manifest::Manifest;
use crate::resolved;
use crate::samples::SampleWriter;
use crate::source::RunSource;
use crate::summary::Summary;

/// Writes a record: what was run before the first step, every step, and the summary at the end. Dropped before the end, it
/// leaves a record without a summary, with every step so far.
pub struct RecordWriter {
    folder: RecordFolder,
    source: RunSource,
    /// Created at the start, when the signals are known.
    files: Option<Files>,
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

    /// Removes the files of the record, if the run has begun. An earlier record that it was to replace stays.
    ///
    /// # Errors
    /// A file can't be removed.
    pub fn discard(self) -> Result<(), WriteError> {
        match self.files {
            Some(files) => {
                drop(files);
                self.folder.clear()
            }
            None => Ok(()),
        }
    }

    /// Writes what is pending, then the summary.
    ///
    /// # Errors
    /// A file can't be written.
    pub fn finish(self, summary: &Summary) -> Result<(), WriteError> {
        match self.files {
            Some(files) => files.finish(&self.folder, summary),
            None => summary.write(&self.folder.path().join(SUMMARY_FILE)),
        }
    }
}

impl StepObserver for RecordWriter {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        let begin = Beginning::new(start, &self.source);
        self.files = Some(begin.write(&self.folder, 0)?);
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        let pushed = self.files.as_mut().map_or(Ok(()), |files| files.push(step));
        pushed.map_err(|error| self.folder.named(error))
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        if let Some(files) = &mut self.files {
            files.push_event(step, event);
        }
        Ok(())
    }

    fn failed(&mut self, error: &RunError) {
        if self.files.is_some() {
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
    pub(crate) fn write(&self, folder: &RecordFolder, first_step: u64) -> Result<Files, WriteError> {
        let files = folder.begin(|path| self.write_files(path, first_step))?;
        // The link is a shortcut. In a folder of all users, such as /tmp, it may belong to another one.
        let _ = folder.link_latest();
        Ok(files)
    }

    fn write_files(&self, path: &Path, first_step: u64) -> Result<Files, WriteError> {
        let Self { manifest, scenario, signals } = self;
        let resolved = resolved::files(scenario).map_err(|error| WriteError {
            path: path.join(SCENARIO_FILE),
            action: "written",
            source: std::io::Error::other(error),
        })?;
        resolved::write(path, &resolved)?;
        let mut attached = vec![(MANIFEST_FILE, manifest.to_json())];
        attached.extend(resolved);
        let period_us = scenario.run.control_period_us;
        let files = Files {
            samples: SampleWriter::create(path, signals, period_us, first_step, &attached)?,
            flush_rows: scenario.record.flush_rows.into(),
            next_step: first_step,
        };
        manifest.write(path)?;
        Ok(files)
    }
}

/// The file that grows.
pub(crate) struct Files {
    samples: SampleWriter,
    flush_rows: u64,
    next_step: u64,
}

impl Files {
    pub(crate) fn push(&mut self, step: &Step) -> Result<(), WriteError> {
        self.samples.push(step);
        self.next_step += 1;
        if self.next_step.is_multiple_of(self.flush_rows) { self.samples.flush() } else { Ok(()) }
    }

    pub(crate) fn push_event(&mut self, step: u32, event: &Event) {
        self.samples.push_event(step, event);
    }

    pub(crate) fn finish(self, folder: &RecordFolder, summary: &Summary) -> Result<(), WriteError> {
        let text = serde_json::to_string_pretty(summary).unwrap_or_default();
        self.samples.finish((SUMMARY_FILE, &text)).map_err(|error| folder.named(error))?;
        summary.write(&folder.path().join(SUMMARY_FILE))
    }
}
