//! What a run yields: verdict, metrics and signals by name.

use std::fmt;

use lashloop_bench::run;
use lashloop_bench::verdict::Verdict;
use lashloop_plant::Signal;
use lashloop_record::columns::Columns;
use lashloop_session::names::UnknownName;

/// A run with its verdict, metrics and signals. Its text is the report of what was missed.
#[derive(Debug, Clone)]
pub struct Outcome {
    run: run::Outcome,
    signals: Columns,
}

/// Why a metric has no value.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoMetric {
    /// No metric has this name.
    #[error("{}: {}", .0.name, .0)]
    Unknown(#[from] UnknownName),
    /// The run has no value for it.
    #[error("{name} has no value: {reason}")]
    NoValue {
        /// The metric.
        name: &'static str,
        /// Why.
        reason: String,
    },
}

/// The message: `main` and tests that return an error print it by `Debug`.
impl fmt::Debug for NoMetric {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, out)
    }
}

impl Outcome {
    pub(crate) fn new(run: run::Outcome, signals: Columns) -> Self {
        Self { run, signals }
    }

    /// PASS, FAIL or INVALID.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.run.judgement.verdict
    }

    /// Whether the run was complete and valid and met every expectation.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.verdict() == Verdict::Pass
    }

    /// A metric over the whole run, such as `settle_time_s`, in the unit of its name.
    ///
    /// # Errors
    /// No metric has this name, or the run has no value for it.
    pub fn metric(&self, name: &str) -> Result<f64, NoMetric> {
        let metrics = &self.run.metrics;
        let Some((metric, measured)) = metrics.iter().find(|(metric, _)| metric.name() == name) else {
            let known = metrics.iter().map(|(metric, _)| metric.name());
            return Err(UnknownName::new("a run", "metric", name, known).into());
        };
        let reason = || NoMetric::NoValue { name: metric.name(), reason: measured.to_string() };
        measured.value().ok_or_else(reason)
    }

    /// A signal as the column of the record: one value for each step, in the unit of its name. `time_s` is the time of each
    /// step; signals of the drive have the prefix `drive.` and are NaN before the first telemetry.
    ///
    /// # Errors
    /// The run has no signal of this name.
    pub fn signal(&self, name: &str) -> Result<&[f64], UnknownName> {
        let known = || self.signals().iter().map(|signal| &*signal.name);
        self.signals.get(name).ok_or_else(|| UnknownName::new("the run", "signal", name, known()))
    }

    /// Every signal, as the record has it. Not stable.
    #[must_use]
    pub fn columns(&self) -> &Columns {
        &self.signals
    }

    /// Name and unit of every signal.
    #[must_use]
    pub fn signals(&self) -> &[Signal] {
        self.signals.signals()
    }

    /// SHA-256 of all torques in hexadecimal. Equal digests mean equal runs.
    #[must_use]
    pub fn torque_sha256(&self) -> &str {
        &self.run.torque_sha256
    }

    /// Everything else that the bench counted and measured. Not stable.
    #[must_use]
    pub fn details(&self) -> &run::Outcome {
        &self.run
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.verdict())?;
        self.run.reasons().iter().try_for_each(|reason| write!(out, "\n{reason}"))
    }
}
