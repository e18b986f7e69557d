//! Why records can't be compared.

use std::path::PathBuf;

use lashloop_session::names::UnknownName;

use crate::reader::ReadError;

/// Why records can't be compared.
#[derive(Debug, thiserror::Error)]
pub enum DiffError {
    /// A record is unusable.
    #[error(transparent)]
    Record(#[from] ReadError),
    /// A file of a record is unusable.
    #[error("{}: can't be used: {problem}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// No time is in both records.
    #[error(
        "{} and {} have no time in common between {from_s} s and {until_s} s: the first has rows from {} s to {} s, the \
         second from {} s to {} s",
        names[0], names[1], ranges_s[0][0], ranges_s[0][1], ranges_s[1][0], ranges_s[1][1]
    )]
    NoCommonTime {
        /// The records.
        names: [String; 2],
        /// First and last time of each.
        ranges_s: [[f64; 2]; 2],
        /// Start of the window.
        from_s: f64,
        /// End of the window.
        until_s: f64,
    },
    /// A tolerance or choice names neither a signal nor a metric.
    #[error("{}: {}", .0.name, .0)]
    Name(#[from] UnknownName),
}
