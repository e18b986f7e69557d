//! `failure.json`: why a run ended without a summary.

use std::io::Write;
use std::path::Path;

use lashloop_bench::atomic_file::{WriteError, write_whole};
use serde::{Deserialize, Serialize};

use crate::file_names::FAILURE_FILE;

/// Why a run ended without a summary.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// The error: of device, link or record, or that the scenario does not fit the drive.
    pub error: String,
}

impl Failure {
    /// Writes the file, whole.
    ///
    /// # Errors
    /// The folder can't be written to.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), WriteError> {
        let text = serde_json::to_string_pretty(self).unwrap_or_default() + "\n";
        write_whole(&folder.join(FAILURE_FILE), ".failure-", |file| file.write_all(text.as_bytes()))
    }
}
