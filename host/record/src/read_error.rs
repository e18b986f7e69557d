//! Why a record is unusable.

use std::io;
use std::path::PathBuf;

use crate::samples::SamplesError;

/// An unusable record: file, line and reason.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", path.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Counted from 1; `None` for an error of the whole file.
    pub line: Option<u64>,
    /// What is wrong.
    pub fault: ReadFault,
}

/// Reasons for an unusable record.
#[derive(Debug, thiserror::Error)]
pub enum ReadFault {
    /// The file can't be read.
    #[error("can't be read: {0}")]
    Read(#[from] io::Error),
    /// A row with another number of fields than the header.
    #[error("fields in this row: {found}; the header has {columns} columns")]
    Fields {
        /// Fields in the row.
        found: usize,
        /// Columns of the header.
        columns: usize,
    },
    /// A field that isn't a number.
    #[error("{column} is {found:?}; it must be a number")]
    NotANumber {
        /// The column.
        column: String,
        /// The field.
        found: String,
    },
    /// A missing column.
    #[error("there is no column {column}; this is not a file that `lashloop run --out` has written")]
    Column {
        /// The column.
        column: String,
    },
    /// A table without rows.
    #[error("has no rows: the run was cut short before its first rows reached the disk")]
    Empty,
    /// Not CSV.
    #[error("is not a table: {0}")]
    Csv(#[from] csv::Error),
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
    /// Not a list of columns.
    #[error("is not the list of a trace's columns: {0}")]
    Columns(serde_json::Error),
}
