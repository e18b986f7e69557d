//! A record with its scenario, as a comparison reads it.

use std::panic::resume_unwind;
use std::path::Path;
use std::thread;

use lashloop_bench::regular_file;
use serde_json::Value;
use toml_edit::de;

use super::error::DiffError;
use crate::file_names::SCENARIO_FILE;
use crate::reader::Record;

/// A record with everything that says what was run.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordFiles {
    /// The folder as the user named it.
    pub name: String,
    /// Manifest, samples, timing and summary.
    pub record: Record,
    /// `scenario.toml`, whose keys are those of its plant and its law too.
    pub scenario: Value,
}

impl RecordFiles {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// A file is unusable, or there are no samples.
    pub fn read(folder: &Path) -> Result<Self, DiffError> {
        let record = Record::read(folder)?;
        let path = folder.join(SCENARIO_FILE);
        let unusable = |problem| DiffError::File { path: path.clone(), problem };
        let text = regular_file::read_toml(&path).map_err(|error| unusable(error.to_string()))?;
        let scenario = de::from_str(&text).map_err(|error| unusable(error.message().replace('\n', "; ")))?;
        Ok(Self { name: folder.display().to_string(), record, scenario })
    }

    /// Reads two folders, each on a thread of its own: reading takes longer than comparing.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_both([a, b]: [&Path; 2]) -> Result<[Self; 2], DiffError> {
        thread::scope(|scope| {
            let second = scope.spawn(|| Self::read(b));
            let first = Self::read(a);
            let second = second.join().unwrap_or_else(|panic| resume_unwind(panic));
            Ok([first?, second?])
        })
    }
}
