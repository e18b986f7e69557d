//! The files that a run writes into its folder.

use std::fs;
use std::path::PathBuf;
use std::rc::Rc;

use lashloop_record::columns::Columns;
use lashloop_record::file_names::SUMMARY_FILE;
use lashloop_record::reader::Record;
use serde_json::Value;
use tempfile::TempDir;

use crate::wait;

/// A folder for `--out`, deleted at the end of the test.
pub struct Records {
    folder: Rc<TempDir>,
    name: PathBuf,
}

/// A table of numbers, column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace(Columns);

impl Default for Records {
    fn default() -> Self {
        Self::new()
    }
}

impl Records {
    /// An empty folder.
    ///
    /// # Panics
    /// The system can't create a folder.
    #[must_use]
    pub fn new() -> Self {
        let folder = Rc::new(tempfile::tempdir().expect("a temporary folder"));
        // In a folder of its own: a record is followed by the link `latest` next to it.
        let records = Self { folder, name: PathBuf::from("record") };
        fs::create_dir(records.path("")).expect("a folder in it");
        records
    }

    /// The folder as an argument of `--out`.
    #[must_use]
    pub fn out(&self) -> String {
        self.folder.path().join(&self.name).display().to_string()
    }

    /// Path of a file in the folder.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(&self.name).join(name)
    }

    /// A record within the folder, of a command that leaves several.
    #[must_use]
    pub fn within(&self, name: &str) -> Self {
        Self { folder: Rc::clone(&self.folder), name: self.name.join(name) }
    }

    /// Text of `summary.json`; `None` without the file.
    #[must_use]
    pub fn summary_text(&self) -> Option<String> {
        fs::read_to_string(self.path("summary.json")).ok()
    }

    /// `summary.json`.
    ///
    /// # Panics
    /// The file is missing or not JSON.
    #[must_use]
    pub fn summary(&self) -> Value {
        let text = self.summary_text().expect("a summary.json");
        serde_json::from_str(&text).expect("summary.json is JSON")
    }

    /// The record.
    ///
    /// # Panics
    /// It can't be read.
    #[must_use]
    pub fn record(&self) -> Record {
        Record::read(&self.path("")).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The columns of the run.
    ///
    /// # Panics
    /// There is no record, or a whole run has left a torn one.
    #[must_use]
    pub fn trace(&self) -> Trace {
        Trace(self.whole().trace)
    }

    /// Timing of each step.
    ///
    /// # Panics
    /// As [`trace`](Self::trace).
    #[must_use]
    pub fn timing(&self) -> Trace {
        Trace(self.whole().timing)
    }

    fn whole(&self) -> Record {
        let (record, has_ended) = (self.record(), self.path(SUMMARY_FILE).exists());
        assert!(!(has_ended && record.is_torn), "the samples of a whole run are torn");
        record
    }

    /// Waits until a run has written steps.
    pub fn wait_for_rows(&self) {
        wait::until("steps in run.mcap", || Record::read(&self.path("")).is_ok().then_some(()));
    }
}

impl Trace {
    /// Names of the columns.
    #[must_use]
    pub fn header(&self) -> Vec<&str> {
        self.0.signals().iter().map(|signal| &*signal.name).collect()
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether the table has no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A column by its name.
    ///
    /// # Panics
    /// No column has this name.
    #[must_use]
    pub fn column(&self, name: &str) -> Vec<f64> {
        self.0.get(name).unwrap_or_else(|| panic!("no column {name}")).to_vec()
    }
}
