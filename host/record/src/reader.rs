//! Reads the record of a run, also of an interrupted one.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use lashloop_bench::regular_file;
use serde::de::DeserializeOwned;

use crate::columns::Columns;
use crate::failure::Failure;
use crate::file_names::{FAILURE_FILE, MANIFEST_FILE, SAMPLES_FILE, SUMMARY_FILE};
use crate::manifest::Manifest;
pub use crate::read_error::{ReadError, ReadFault};
use crate::samples::{RecordedEdge, RecordedText, Samples, SamplesError};
use crate::summary::Summary;

/// The folder of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Where it is.
    pub folder: PathBuf,
    /// What was run.
    pub manifest: Manifest,
    /// The columns of the run with their units, one row per step.
    pub trace: Columns,
    /// Timing of each step.
    pub timing: Columns,
    /// Begins and ends of injected faults.
    pub faults: Vec<RecordedEdge>,
    /// Texts of the drive.
    pub logs: Vec<RecordedText>,
    /// Whether the samples end within a chunk, which is omitted.
    pub is_torn: bool,
    /// The summary, if the run has a verdict.
    pub summary: Option<Summary>,
    /// Why there is no summary; `None` for a run that was killed, and with a summary.
    pub failure: Option<Failure>,
}

impl Record {
    /// Reads the folder that a run wrote with `--out`.
    ///
    /// # Errors
    /// The samples have no rows, or one of the files is unusable.
    pub fn read(folder: &Path) -> Result<Self, ReadError> {
        let record = Self::read_any(folder)?;
        if record.trace.is_empty() { Err(record.no_rows()) } else { Ok(record) }
    }

    /// Reads the folder of a run that may have ended before its first torque.
    ///
    /// # Errors
    /// One of the files is unusable.
    pub fn read_any(folder: &Path) -> Result<Self, ReadError> {
        if !folder.join(MANIFEST_FILE).exists() && !folder.join(SAMPLES_FILE).exists() {
            let fault = if folder.exists() { ReadFault::NoRecord } else { ReadFault::NoFolder };
            return Err(ReadError { path: folder.to_owned(), fault });
        }
        let manifest = read_json(&folder.join(MANIFEST_FILE), ReadFault::Manifest)?;
        let Samples { trace, timing, faults, logs, is_torn } = read_samples(&folder.join(SAMPLES_FILE))?;
        let summary = if_it_exists(read_json(&folder.join(SUMMARY_FILE), ReadFault::Summary))?;
        let failure = if_it_exists(read_json(&folder.join(FAILURE_FILE), ReadFault::Failure))?;
        let failure = failure.filter(|_| summary.is_none());
        let folder = folder.to_owned();
        Ok(Self { folder, manifest, trace, timing, faults, logs, is_torn, summary, failure })
    }

    /// The error of a record without rows.
    #[must_use]
    pub fn no_rows(&self) -> ReadError {
        self.unusable(ReadFault::Empty)
    }

    /// A column of the trace.
    ///
    /// # Errors
    /// The trace has no column of this name.
    pub fn column(&self, name: &str) -> Result<&[f64], ReadError> {
        let absent = || self.unusable(ReadFault::Column { column: name.to_owned() });
        self.trace.get(name).ok_or_else(absent)
    }

    /// What an interrupted run left, or one that is still going on; `None` if the run has its summary.
    #[must_use]
    pub fn interruption(&self) -> Option<String> {
        let cut = if self.is_torn { "; what follows is cut and omitted" } else { "" };
        let steps = self.trace.len();
        let text = || format!("interrupted: no {SUMMARY_FILE}, {steps} steps reached the disk{cut}");
        self.summary.is_none().then(text)
    }

    fn unusable(&self, fault: ReadFault) -> ReadError {
        ReadError { path: self.folder.join(SAMPLES_FILE), fault }
    }
}

fn read_samples(path: &Path) -> Result<Samples, ReadError> {
    Samples::read(path).map_err(|error| {
        let fault = match error {
            SamplesError::Read(source) => ReadFault::Read(source),
            other => ReadFault::Samples(other),
        };
        ReadError { path: path.to_owned(), fault }
    })
}

fn read_json<T: DeserializeOwned>(
    path: &Path,
    fault: fn(serde_json::Error) -> ReadFault,
) -> Result<T, ReadError> {
    let error = |fault| ReadError { path: path.to_owned(), fault };
    let text = regular_file::read_text(path).map_err(|source| error(source.into()))?;
    serde_json::from_str(&text).map_err(|source| error(fault(source)))
}

fn if_it_exists<T>(read: Result<T, ReadError>) -> Result<Option<T>, ReadError> {
    match read {
        Ok(found) => Ok(Some(found)),
        Err(ReadError { fault: ReadFault::Read(source), .. }) if source.kind() == ErrorKind::NotFound => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}
