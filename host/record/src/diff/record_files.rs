//! The files of a record that a comparison reads.

use std::fs;
use std::io::ErrorKind;
use std::panic::resume_unwind;
use std::path::Path;
use std::thread;

use serde_json::Value;
use toml_edit::de;

use super::error::DiffError;
use crate::file_names::{MANIFEST_FILE, SCENARIO_FILE, SUMMARY_FILE};
use crate::reader::Record;

/// A record with everything that says what was run. Manifest and summary are read as they are, so that a comparison
/// covers each of their entries.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordFiles {
    /// The folder as the user named it.
    pub name: String,
    /// Whether the samples have the bits of the run. Those of `trace.csv` are rounded from format 2 on.
    pub has_every_bit: bool,
    /// Samples and timing.
    pub record: Record,
    /// `record.json`; `None` in a record of format 1.
    pub manifest: Option<Value>,
    /// `scenario.toml`; `None` in a record of format 1.
    pub scenario: Option<Value>,
    /// `summary.json`; `None` if the run was interrupted.
    pub summary: Option<Value>,
}

impl RecordFiles {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// A file is unusable, or there are no samples.
    pub fn read(folder: &Path) -> Result<Self, DiffError> {
        let record = Record::read(folder)?;
        let json = |name: &str| {
            let path = folder.join(name);
            let unusable = |problem| DiffError::File { path: path.clone(), problem };
            let text = text_if_it_exists(&path)?;
            text.map(|text| serde_json::from_str(&text).map_err(|error| unusable(error.to_string())))
                .transpose()
        };
        let path = folder.join(SCENARIO_FILE);
        let scenario = text_if_it_exists(&path)?.map(|text| {
            de::from_str(&text)
                .map_err(|error| DiffError::File { path, problem: error.message().replace('\n', "; ") })
        });
        let manifest = json(MANIFEST_FILE)?;
        Ok(Self {
            has_every_bit: manifest.is_none() || record.is_of_samples(),
            name: folder.display().to_string(),
            record,
            manifest,
            scenario: scenario.transpose()?,
            summary: json(SUMMARY_FILE)?,
        })
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

    /// Whether the drive read its own encoders, in bench mode.
    #[must_use]
    pub fn is_in_bench_mode(&self) -> bool {
        self.entry("mode").and_then(Value::as_str) == Some("bench")
    }

    /// The device, as the record describes it.
    #[must_use]
    pub fn device(&self) -> Option<&str> {
        self.entry("device_description").or_else(|| self.entry("device"))?.as_str()
    }

    /// How often a lost drive came back; `None` for an interrupted run.
    #[must_use]
    pub fn resumes(&self) -> Option<u64> {
        self.summary.as_ref()?["link"]["resumes"].as_u64()
    }

    /// An entry of the manifest, or else of the summary.
    pub(super) fn entry(&self, key: &str) -> Option<&Value> {
        [&self.manifest, &self.summary].into_iter().flatten().find_map(|file| file.get(key))
    }
}

fn text_if_it_exists(path: &Path) -> Result<Option<String>, DiffError> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(DiffError::File { path: path.to_owned(), problem: error.to_string() }),
    }
}
