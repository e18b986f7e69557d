//! `failure.json`: why a run ended without a summary.

use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use serde::{Deserialize, Serialize};

use crate::file_names::FAILURE_FILE;
use crate::json_file::write_json;

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
        write_json(&folder.join(FAILURE_FILE), ".failure-", self)
    }
}
