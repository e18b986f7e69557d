//! What one run of the battery scores. A run without a figure ranks behind every run with one.

use std::cmp::Ordering;
use std::fmt;

use serde::{Deserialize, Serialize};

use lashloop_bench::run::{End, Outcome};
use lashloop_bench::verdict::Verdict;
use lashloop_plant::metrics::{Measured, Metric, Metrics};

/// A figure that the battery looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Time into 0.05 rad, for good.
    SettleTime,
    /// Error of the last second.
    StaticError,
    /// Peak to peak of the last 10 s.
    Hunting,
    /// The drive's last estimate of j0 less the true one.
    DeadZoneError,
    /// Integral of the torque squared.
    Effort,
    /// Sum of the torque's changes.
    TorqueVariation,
}

impl Criterion {
    /// Every figure, in the order of the tables.
    pub const ALL: [Self; 6] = [
        Self::SettleTime,
        Self::StaticError,
        Self::Hunting,
        Self::DeadZoneError,
        Self::Effort,
        Self::TorqueVariation,
    ];

    /// The metric it is taken from.
    #[must_use]
    pub const fn metric(self) -> Metric {
        match self {
            Self::SettleTime => Metric::SettleTime,
            Self::StaticError => Metric::StaticError,
            Self::Hunting => Metric::Hunting,
            Self::DeadZoneError => Metric::DeadZoneError,
            Self::Effort => Metric::Effort,
            Self::TorqueVariation => Metric::TorqueTotalVariation,
        }
    }

    /// Name in a table; sizes of figures are compared there, without their signs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::SettleTime => "settle time",
            Self::StaticError => "static error",
            Self::Hunting => "hunting",
            Self::DeadZoneError => "|j_hat - j0|",
            Self::Effort => "effort",
            Self::TorqueVariation => "variation",
        }
    }

    /// Unit in a table.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::SettleTime => "s",
            Self::StaticError | Self::Hunting | Self::DeadZoneError => "mrad",
            Self::Effort => "N^2 m^2 s",
            Self::TorqueVariation => "N m",
        }
    }

    /// A value in SI units as a table shows it.
    #[must_use]
    pub fn show(self, si: f64) -> String {
        match self {
            Self::SettleTime => format!("{si:.2}"),
            Self::StaticError | Self::Hunting | Self::DeadZoneError => format!("{:.2}", si * 1e3),
            Self::Effort | Self::TorqueVariation => format!("{si:.0}"),
        }
    }
}

/// A figure of one run, or why there is none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Score {
    /// A finite number in the unit of the metric.
    Value(f64),
    /// Why there is no number.
    Missing(MissingReason),
}

/// Why a run has no figure; the worse the later.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum MissingReason {
    /// The metric does not apply to this run.
    #[serde(rename = "none")]
    Unmeasured,
    /// The load never stayed in the band.
    #[serde(rename = "never")]
    Never,
    /// The run did not reach its end: the drive latched a fault, above all.
    #[serde(rename = "cut short")]
    CutShort,
    /// Something was not finite, or the plant could not be followed.
    #[serde(rename = "not finite")]
    NotFinite,
}

impl Score {
    /// The number, if there is one.
    #[must_use]
    pub const fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Missing(_) => None,
        }
    }

    /// The score without its sign.
    #[must_use]
    pub fn size(self) -> Self {
        match self {
            Self::Value(value) => Self::Value(value.abs()),
            reason @ Self::Missing(_) => reason,
        }
    }

    /// The better first. What has no number, or none that is finite, is behind all that has.
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

impl fmt::Display for MissingReason {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(match self {
            Self::Unmeasured => "none",
            Self::Never => "never",
            Self::CutShort => "cut short",
            Self::NotFinite => "not finite",
        })
    }
}

/// The figures of one run, with their signs, by the names of their metrics.
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
    /// What a run scores.
    #[must_use]
    pub fn of(outcome: &Outcome) -> Self {
        Self::judged(&outcome.end, outcome.judgement.verdict, &outcome.metrics)
    }

    fn judged(end: &End, verdict: Verdict, metrics: &Metrics) -> Self {
        let score = |criterion: Criterion| match (end, metrics.get(criterion.metric())) {
            (End::Diverged(_), _) | (_, Measured::NotFinite) => Score::Missing(MissingReason::NotFinite),
            // What was measured up to the fault is no figure of the whole run.
            (End::DriveFault(_) | End::DriveRestarted | End::Interrupted, _) => {
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

    /// One of them.
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
