//! Why a record is unusable.

use std::io;
use std::path::PathBuf;

use lashloop_session::printable;

use crate::samples::SamplesError;

/// An unusable record: file and reason.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub fault: ReadFault,
}

/// Reasons for an unusable record.
#[derive(Debug, thiserror::Error)]
pub enum ReadFault {
    /// The file can't be read.
    #[error("can't be read: {0}")]
    Read(#[from] io::Error),
    /// Nothing is there.
    #[error("the folder doesn't exist; name one that `lashloop run --out` has written")]
    NoFolder,
    /// It isn't a record.
    #[error("holds no record; name a folder that `lashloop run --out` has written")]
    NoRecord,
    /// A missing column.
    #[error("there is no column {column}; this is not a file that `lashloop run --out` has written")]
    Column {
        /// The column.
        column: String,
    },
    /// Samples without rows.
    #[error("has no rows: the run was cut short before its first rows reached the disk")]
    Empty,
    /// Not a summary.
    #[error("is not the summary of a run: {}", printable(&.0.to_string()))]
    Summary(serde_json::Error),
    /// Not a failure.
    #[error("is not the failure of a run: {}", printable(&.0.to_string()))]
    Failure(serde_json::Error),
    /// Not a manifest.
    #[error("is not the manifest of a record: {}", printable(&.0.to_string()))]
    Manifest(serde_json::Error),
    /// Not samples.
    #[error(transparent)]
    Samples(SamplesError),
}
