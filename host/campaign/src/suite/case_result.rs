//! The result of a case.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::check::Check;
use lashloop_bench::run::Outcome;
use lashloop_bench::verdict::{Exit, Verdict};
use serde::{Deserialize, Serialize};

/// What became of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    Pass,
    /// The device can't run it by design, such as bench mode on a drive without pins.
    Skipped,
    Fail,
    /// The scenario is wrong, or does not fit the drive.
    BadScenario,
    Invalid,
    /// Device or link failed.
    DeviceOrLink,
}

impl Status {
    pub const ALL: [Self; 6] =
        [Self::Pass, Self::Fail, Self::Invalid, Self::BadScenario, Self::DeviceOrLink, Self::Skipped];

    /// The word in tables.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Pass => "PASS",
            Self::Skipped => "SKIPPED",
            Self::Fail => "FAIL",
            Self::BadScenario | Self::DeviceOrLink => "ERROR",
            Self::Invalid => "INVALID",
        }
    }

    /// Whether a run was judged.
    #[must_use]
    pub const fn is_verdict(self) -> bool {
        match self {
            Self::Pass | Self::Fail | Self::Invalid => true,
            Self::Skipped | Self::BadScenario | Self::DeviceOrLink => false,
        }
    }

    /// The exit code of a run that ends so.
    #[must_use]
    pub const fn exit(self) -> Exit {
        match self {
            Self::Pass | Self::Skipped => Exit::Pass,
            Self::Fail => Exit::Fail,
            Self::BadScenario => Exit::UsageOrScenario,
            Self::Invalid => Exit::Invalid,
            Self::DeviceOrLink => Exit::DeviceOrLink,
        }
    }
}

impl From<Verdict> for Status {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Pass => Self::Pass,
            Verdict::Fail => Self::Fail,
            Verdict::Invalid => Self::Invalid,
        }
    }
}

/// A line of the journal: what a run has left, before its metrics are compared with their baseline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseResult {
    /// Name of the case.
    pub case: String,
    /// SHA-256 of the scenario with every default and the table of its reference; none for a scenario that can't be read.
    pub scenario_sha256: Option<String>,
    pub status: Status,
    /// Why it is not PASS.
    pub reasons: Vec<String>,
    pub checks: Vec<Check>,
    /// Metrics that have a value.
    pub metrics: BTreeMap<String, f64>,
    /// What ran as the drive.
    pub device: String,
    pub wall_s: f64,
    pub torque_sha256: Option<String>,
    /// Folder of the record, if it was kept.
    pub record: Option<PathBuf>,
}

impl CaseResult {
    /// A case without a verdict.
    #[must_use]
    pub fn without_run(case: &str, status: Status, reasons: Vec<String>) -> Self {
        Self {
            case: case.to_owned(),
            scenario_sha256: None,
            status,
            reasons,
            checks: Vec::new(),
            metrics: BTreeMap::new(),
            device: String::new(),
            wall_s: 0.0,
            torque_sha256: None,
            record: None,
        }
    }

    /// A run with its verdict.
    #[must_use]
    pub fn of_run(case: &str, device: String, outcome: &Outcome) -> Self {
        let judgement = &outcome.judgement;
        let values = outcome.metrics.iter();
        Self {
            reasons: outcome.reasons(),
            checks: judgement.expectations.iter().map(Check::from).collect(),
            metrics: values
                .filter_map(|(metric, measured)| Some((metric.name().to_owned(), measured.value()?)))
                .collect(),
            device,
            wall_s: outcome.wall_s,
            torque_sha256: Some(outcome.torque_sha256.clone()),
            ..Self::without_run(case, judgement.verdict.into(), Vec::new())
        }
    }

    /// Adds checks, of which a missed one makes PASS a FAIL.
    pub fn add_checks(&mut self, checks: Vec<Check>, reasons: Vec<String>) {
        if self.status == Status::Pass && checks.iter().any(|check| !check.ok) {
            self.status = Status::Fail;
        }
        self.checks.extend(checks);
        self.reasons.extend(reasons);
    }
}
