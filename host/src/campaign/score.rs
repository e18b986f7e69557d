//! The scores of one run. A missing value ranks behind every value.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use lashloop_bench::run::{End, Outcome};
use lashloop_bench::verdict::Verdict;
use lashloop_plant::metrics::{Measured, Metric, Metrics};

/// A criterion of a run, taken from one of its metrics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Time until the load stays within 0.05 rad.
    SettleTime,
    /// Mean error over the last second.
    StaticError,
    /// Peak-to-peak position over the last 10 s.
    Hunting,
    /// Last estimate of j0, less its true value.
    DeadZoneError,
    /// Integral of the torque squared.
    Effort,
    /// Total variation of the torque.
    TorqueVariation,
}

impl Criterion {
    /// In the order of the tables.
    pub const ALL: [Self; 6] = [
        Self::SettleTime,
        Self::StaticError,
        Self::Hunting,
        Self::DeadZoneError,
        Self::Effort,
        Self::TorqueVariation,
    ];

    /// Metric; name and unit in a table, which shows magnitudes; the table's unit per SI unit; decimals.
    const fn column(self) -> (Metric, &'static str, &'static str, f64, usize) {
        match self {
            Self::SettleTime => (Metric::SettleTime, "settle time", "s", 1.0, 2),
            Self::StaticError => (Metric::StaticError, "static error", "mrad", 1e3, 2),
            Self::Hunting => (Metric::Hunting, "hunting", "mrad", 1e3, 2),
            Self::DeadZoneError => (Metric::DeadZoneError, "|j_hat - j0|", "mrad", 1e3, 2),
            Self::Effort => (Metric::Effort, "effort", "N^2 m^2 s", 1.0, 0),
            Self::TorqueVariation => (Metric::TorqueTotalVariation, "variation", "N m", 1.0, 0),
        }
    }

    #[must_use]
    pub const fn metric(self) -> Metric {
        self.column().0
    }

    #[must_use]
    pub const fn name(self) -> &'static str {
        self.column().1
    }

    #[must_use]
    pub const fn unit(self) -> &'static str {
        self.column().2
    }

    /// Formats a value in SI units in the unit of the table.
    #[must_use]
    pub fn show(self, si: f64) -> String {
        let (_, _, _, per_si, decimals) = self.column();
        format!("{:.decimals$}", si * per_si)
    }

    /// The magnitude of a score in the unit of the table, or the reason for its absence.
    #[must_use]
    pub fn cell(self, score: Score) -> String {
        match score.magnitude() {
            Score::Value(magnitude) => self.show(magnitude),
            Score::Missing(reason) => reason.to_string(),
        }
    }
}

/// The value of a criterion, or the reason for its absence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Score {
    /// Finite, in the unit of the metric.
    Value(f64),
    Missing(MissingReason),
}

/// Why a run has no value, from the least to the most severe reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum MissingReason {
    /// The metric does not apply to this run.
    #[serde(rename = "none")]
    Unmeasured,
    /// The load never settled within the band.
    #[serde(rename = "never")]
    Never,
    /// The run ended early, usually because the drive latched a fault.
    #[serde(rename = "cut short")]
    CutShort,
    /// A value was not finite, or the plant could not be integrated.
    #[serde(rename = "not finite")]
    NotFinite,
}

impl Score {
    #[must_use]
    pub const fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Missing(_) => None,
        }
    }

    #[must_use]
    pub fn magnitude(self) -> Self {
        match self {
            Self::Value(value) => Self::Value(value.abs()),
            reason @ Self::Missing(_) => reason,
        }
    }

    /// Orders by value, best first. Missing and non-finite values rank behind every finite value.
    #[must_use]
    pub fn order(&self, other: &Self) -> Ordering {
        let rank = |score: &Self| match score {
            Self::Value(value) if value.is_finite() => (*value, None),
            Self::Value(_) => (f64::INFINITY, Some(MissingReason::NotFinite)),
            Self::Missing(reason) => (f64::INFINITY, Some(*reason)),
        };
        let ((one, one_reason), (two, two_reason)) = (rank(self), rank(other));
        one.total_cmp(&two).then(one_reason.cmp(&two_reason))
    }
}

/// The signed scores of one run, by the names of their metrics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scores {
    settle_time_s: Score,
    static_error_rad: Score,
    hunting_rad: Score,
    dead_zone_error_rad: Score,
    effort_nm2s: Score,
    torque_total_variation_nm: Score,
}

impl Scores {
    #[must_use]
    pub fn of(outcome: &Outcome) -> Self {
        Self::judged(&outcome.end, outcome.judgement.verdict, &outcome.metrics)
    }

    fn judged(end: &End, verdict: Verdict, metrics: &Metrics) -> Self {
        let score = |criterion: Criterion| match (end, metrics.get(criterion.metric())) {
            (End::Diverged(_), _) | (_, Measured::NotFinite) => Score::Missing(MissingReason::NotFinite),
            // A metric measured up to the fault does not describe the whole run.
            (End::DriveFault(_) | End::RuleBroken(_) | End::DriveRestarted | End::Interrupted, _) => {
                Score::Missing(MissingReason::CutShort)
            }
            _ if verdict == Verdict::Invalid => Score::Missing(MissingReason::CutShort),
            (End::Complete, Measured::Value(value)) => Score::Value(value),
            (End::Complete, Measured::Never) => Score::Missing(MissingReason::Never),
            (End::Complete, _) => Score::Missing(MissingReason::Unmeasured),
        };
        Self {
            settle_time_s: score(Criterion::SettleTime),
            static_error_rad: score(Criterion::StaticError),
            hunting_rad: score(Criterion::Hunting),
            dead_zone_error_rad: score(Criterion::DeadZoneError),
            effort_nm2s: score(Criterion::Effort),
            torque_total_variation_nm: score(Criterion::TorqueVariation),
        }
    }

    #[must_use]
    pub const fn get(&self, criterion: Criterion) -> Score {
        match criterion {
            Criterion::SettleTime => self.settle_time_s,
            Criterion::StaticError => self.static_error_rad,
            Criterion::Hunting => self.hunting_rad,
            Criterion::DeadZoneError => self.dead_zone_error_rad,
            Criterion::Effort => self.effort_nm2s,
            Criterion::TorqueVariation => self.torque_total_variation_nm,
        }
    }
}

#[cfg(test)]
mod tests;
