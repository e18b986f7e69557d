//! A run as a page shows it: its record and its timing.

use std::path::Path;

use lashloop_bench::fault::timeline::FaultRecord;
use lashloop_record::reader::{ReadError, Record};
use lashloop_record::samples::RecordedEdge;
use lashloop_record::timing::TimingRow;

/// A recorded run with the name that a page gives it.
#[derive(Debug, Clone)]
pub struct Run {
    pub(super) name: String,
    pub(super) record: Record,
    pub(super) timing: Vec<TimingRow>,
}

impl Run {
    /// Reads the folder of a run. A run that ended before its first torque has a summary and no rows.
    ///
    /// # Errors
    /// The folder has neither rows nor a summary, or one of its files is unusable.
    pub fn read(name: impl Into<String>, folder: &Path) -> Result<Self, ReadError> {
        let record = Record::read_any(folder)?;
        let is_empty = record.trace.is_empty() && record.summary.is_none();
        if is_empty { Err(record.no_rows()) } else { Ok(Self::new(name, record)) }
    }

    /// The run of a record.
    #[must_use]
    pub fn new(name: impl Into<String>, record: Record) -> Self {
        let timing = record.timing.rows();
        Self { name: name.into(), record, timing }
    }

    /// A column of the trace with at least one finite value.
    pub(super) fn column(&self, name: &str) -> Option<&[f64]> {
        self.record.trace.get(name).filter(|values| values.iter().any(|value| value.is_finite()))
    }

    /// The control period.
    pub(super) fn period_s(&self) -> f64 {
        f64::from(self.record.manifest.period_us) * 1e-6
    }

    /// The injected faults: of the summary, or of an interrupted run those that began up to there.
    pub(super) fn faults(&self) -> Vec<FaultRecord> {
        if let Some(summary) = &self.record.summary {
            return summary.faults.clone();
        }
        let edges = &self.record.faults;
        let end = |number| edges.iter().find(|edge| !edge.begins && edge.number == number);
        let fault = |begin: &RecordedEdge| FaultRecord {
            kind: begin.kind.clone().into(),
            step: begin.step as u32,
            until_step: end(begin.number).map(|edge| edge.step as u32),
            frames: None,
        };
        edges.iter().filter(|edge| edge.begins).map(fault).collect()
    }

    /// Times of the steps, in s.
    pub(super) fn times_s(&self) -> &[f64] {
        self.record.trace.get("time_s").unwrap_or_default()
    }

    /// The scenario's title.
    pub(super) fn title(&self) -> &str {
        &self.record.manifest.scenario.name
    }
}
