//! A run as a page shows it: its record and its whole summary.

use std::path::Path;

use lashloop_record::file_names::SUMMARY_FILE;
use lashloop_record::reader::{ReadError, Record, Table};
use lashloop_record::samples::RecordedEdge;
use lashloop_record::timing::TimingRow;

use super::summary::{Fault, Summary};

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
    /// Reads the folder of a run. A run that ended before its first torque has a summary and no rows.
    ///
    /// # Errors
    /// The folder has neither rows nor a summary, or one of its files is unusable.
    pub fn read(name: impl Into<String>, folder: &Path) -> Result<Self, ReadError> {
        let run = Self::new(name, Record::read_any(folder)?)?;
        if run.times_s().is_empty() && run.summary.is_none() { Err(run.record.no_rows()) } else { Ok(run) }
    }

    /// The run of a record.
    ///
    /// # Errors
    /// Its summary or its timing is unusable.
    pub fn new(name: impl Into<String>, record: Record) -> Result<Self, ReadError> {
        let path = record.folder.join(SUMMARY_FILE);
        let summary =
            Summary::read(&path).map_err(|fault| ReadError { path: path.clone(), line: None, fault })?;
        let timing = record.timing.as_ref().map(Table::rows::<TimingRow>).transpose()?.unwrap_or_default();
        Ok(Self { name: name.into(), record, summary, timing })
    }

    /// A column of the trace with at least one finite value.
    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        self.record.trace.columns.get(name).filter(|values| values.iter().any(|value| value.is_finite()))
    }

    /// The control period; 0 if the record doesn't have it.
    pub(super) fn period_s(&self) -> f64 {
        let of_summary = || self.summary.as_ref().map(|summary| summary.timing.period_us);
        let period_us = self.record.manifest.as_ref().map(|manifest| manifest.period_us).or_else(of_summary);
        f64::from(period_us.unwrap_or_default()) * 1e-6
    }

    /// The injected faults: of the summary, or of an interrupted run those that began up to there.
    pub(super) fn faults(&self) -> Vec<Fault> {
        if let Some(summary) = &self.summary {
            return summary.faults.clone();
        }
        let edges = &self.record.faults;
        let end = |number| edges.iter().find(|edge| !edge.begins && edge.number == number);
        let fault = |begin: &RecordedEdge| Fault {
            kind: begin.kind.clone(),
            step: begin.step,
            until_step: end(begin.number).map(|edge| edge.step),
            frames: None,
        };
        edges.iter().filter(|edge| edge.begins).map(fault).collect()
    }

    /// Times of the steps, in s.
    pub(super) fn times_s(&self) -> &[f64] {
        self.record.trace.columns.get("time_s").unwrap_or_default()
    }

    /// The scenario's title, else its file, else the record's name.
    pub(super) fn title(&self) -> &str {
        match (&self.record.manifest, &self.summary) {
            (Some(manifest), _) => &manifest.scenario.name,
            (None, Some(summary)) => &summary.scenario,
            (None, None) => &self.name,
        }
    }
}
