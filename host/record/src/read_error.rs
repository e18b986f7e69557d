//! Why a record is unusable.

use std::io;
use std::path::PathBuf;

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
    #[error("is not the summary of a run: {0}")]
    Summary(serde_json::Error),
    /// Not a failure.
    #[error("is not the failure of a run: {0}")]
    Failure(serde_json::Error),
    /// Not a manifest.
    #[error("is not the manifest of a record: {0}")]
    Manifest(serde_json::Error),
    /// Not samples.
    #[error(transparent)]
    Samples(SamplesError),
}
