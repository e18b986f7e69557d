//! A run as a page shows it: its record and its whole summary.

use std::path::Path;

use lashloop_record::reader::{ReadError, Record, Table};
use lashloop_record::file_names::SUMMARY_FILE;
use lashloop_record::timing::TimingRow;

use super::summary::Summary;

/// A recorded run with the name that a page gives it.
#[derive(Debug, Clone)]
pub struct Run {
    pub(super) name: String,
    pub(super) record: Record,
    /// `None` for an interrupted run.
    pub(super) summary: Option<Summary>,
    /// All rows of the timing. After a killed run there may be fewer than in the trace.
    pub(super) timing: Vec<TimingRow>,
}

impl Run {
    /// Reads the folder of a run.
    ///
    /// # Errors
    /// The folder has no trace, or one of its files is unusable.
    pub fn read(name: impl Into<String>, folder: &Path) -> Result<Self, ReadError> {
        let record = Record::read(folder)?;
        let path = folder.join(SUMMARY_FILE);
        let summary =
            Summary::read(&path).map_err(|fault| ReadError { path: path.clone(), line: None, fault })?;
        let timing = record.timing.as_ref().map(Table::rows).transpose()?.unwrap_or_default();
        Ok(Self { name: name.into(), record, summary, timing })
    }

    /// A column of the trace with at least one finite value.
    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        self.record.trace.columns.get(name).filter(|values| values.iter().any(|value| value.is_finite()))
    }

    /// Times of the steps, in s.
    pub(super) fn times_s(&self) -> &[f64] {
        self.record.trace.columns.get("time_s").unwrap_or_default()
    }

    /// The scenario's title, else its file, else the record's name.
    pub(super) fn title(&self) -> &str {
        match &self.summary {
            Some(Summary { title: Some(title), .. }) => title,
            Some(summary) => &summary.scenario,
            None => &self.name,
        }
    }
}
