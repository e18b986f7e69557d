//! The scores of one run. A missing value ranks behind every value.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use lashloop_bench::run::{End, Outcome};
use lashloop_bench::verdict::Verdict;
use lashloop_firmware::control::braking_curve::LEARNT_DEVIATION_RAD;
use lashloop_plant::metrics::{Measured, Metric, Metrics};

/// Smallest band of [`Criterion::StaticErrorInBands`].
const BAND_RAD: f64 = 2e-3;

/// A criterion of a run, taken from its metrics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Time until the load stays within 0.05 rad.
    SettleTime,
    /// Largest error beyond the target.
    Overshoot,
    /// Mean error over the last second.
    StaticError,
    /// The same relative to 2 mrad, or to one count of the load encoder where that is wider.
    StaticErrorInBands,
    /// Peak-to-peak position over the last 10 s.
    Hunting,
    /// Last estimate of j0, less its true value.
    DeadZoneError,
    /// The same where the gap counts as learnt: where the deviation of the estimate is at most [`LEARNT_DEVIATION_RAD`].
    LearntDeadZoneError,
    /// Last standard deviation of the estimate of j0, as reported by the drive.
    DeadZoneDeviation,
    /// Integral of the torque squared.
    Effort,
    /// Total variation of the torque.
    TorqueVariation,
}

impl Criterion {
    /// In the order of the tables.
    pub const ALL: [Self; 10] = [
        Self::SettleTime,
        Self::Overshoot,
        Self::StaticError,
        Self::StaticErrorInBands,
        Self::Hunting,
        Self::DeadZoneError,
        Self::LearntDeadZoneError,
        Self::DeadZoneDeviation,
        Self::Effort,
        Self::TorqueVariation,
    ];

    /// The columns of a sweep.
    pub const SWEPT: [Self; 8] = [
        Self::SettleTime,
        Self::Overshoot,
        Self::StaticError,
        Self::Hunting,
        Self::DeadZoneError,
        Self::DeadZoneDeviation,
        Self::Effort,
        Self::TorqueVariation,
    ];

    /// Name in `runs.csv`; name and unit in a table, which shows magnitudes; the table's unit per SI unit; decimals.
    const fn column(self) -> (&'static str, &'static str, &'static str, f64, usize) {
        match self {
            Self::SettleTime => (Metric::SettleTime.name(), "settle time", "s", 1.0, 2),
            Self::Overshoot => (Metric::Overshoot.name(), "overshoot", "mrad", 1e3, 2),
            Self::StaticError => (Metric::StaticError.name(), "static error", "mrad", 1e3, 2),
            Self::StaticErrorInBands => ("static_error_bands", "static error", "bands", 1.0, 2),
            Self::Hunting => (Metric::Hunting.name(), "hunting", "mrad", 1e3, 2),
            Self::DeadZoneError => (Metric::DeadZoneError.name(), "|j_hat - j0|", "mrad", 1e3, 2),
            Self::LearntDeadZoneError => {
                ("learnt_dead_zone_error_rad", "learnt |j_hat - j0|", "mrad", 1e3, 2)
            }
            Self::DeadZoneDeviation => (Metric::DeadZoneDeviation.name(), "sigma(j_hat)", "mrad", 1e3, 2),
            Self::Effort => (Metric::Effort.name(), "effort", "N^2 m^2 s", 1.0, 0),
            Self::TorqueVariation => (Metric::TorqueTotalVariation.name(), "variation", "N m", 1.0, 0),
        }
    }

    /// Name in `runs.csv`: that of the metric, where the criterion is one.
    #[must_use]
    pub const fn key(self) -> &'static str {
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
    /// The gap does not count as learnt.
    #[serde(rename = "not learnt")]
    NotLearnt,
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

/// The signed scores of one run, by the keys of the criteria and in their order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scores {
    settle_time_s: Score,
    overshoot_rad: Score,
    static_error_rad: Score,
    static_error_bands: Score,
    hunting_rad: Score,
    dead_zone_error_rad: Score,
    learnt_dead_zone_error_rad: Score,
    dead_zone_deviation_rad: Score,
    effort_nm2s: Score,
    torque_total_variation_nm: Score,
}

impl Scores {
    /// Scores of a run behind a load encoder of this resolution.
    #[must_use]
    pub fn of(outcome: &Outcome, load_counts_per_rev: u32) -> Self {
        let band_rad = BAND_RAD.max(TAU / f64::from(load_counts_per_rev));
        Self::judged(&outcome.end, outcome.judgement.verdict, &outcome.metrics, band_rad)
    }

    fn judged(end: &End, verdict: Verdict, metrics: &Metrics, band_rad: f64) -> Self {
        let score = |metric: Metric| match (end, metrics.get(metric)) {
            (End::Diverged(_), _) | (_, Measured::NotFinite) => Score::Missing(MissingReason::NotFinite),
            // A metric measured up to the fault does not describe the whole run.
            (
                End::DriveFault(_)
                | End::RuleBroken(_)
                | End::DriveRestarted
                | End::BeyondTravel { .. }
                | End::Interrupted,
                _,
            ) => Score::Missing(MissingReason::CutShort),
            _ if verdict == Verdict::Invalid => Score::Missing(MissingReason::CutShort),
            (End::Complete, Measured::Value(value)) => Score::Value(value),
            (End::Complete, Measured::Never) => Score::Missing(MissingReason::Never),
            (End::Complete, _) => Score::Missing(MissingReason::Unmeasured),
        };
        let static_error = score(Metric::StaticError);
        let dead_zone_error = score(Metric::DeadZoneError);
        let deviation = score(Metric::DeadZoneDeviation);
        Self {
            settle_time_s: score(Metric::SettleTime),
            overshoot_rad: score(Metric::Overshoot),
            static_error_rad: static_error,
            static_error_bands: match static_error {
                Score::Value(error_rad) => Score::Value(error_rad / band_rad),
                missing @ Score::Missing(_) => missing,
            },
            hunting_rad: score(Metric::Hunting),
            dead_zone_error_rad: dead_zone_error,
            learnt_dead_zone_error_rad: match deviation {
                Score::Value(deviation_rad) if deviation_rad <= LEARNT_DEVIATION_RAD => dead_zone_error,
                Score::Value(_) => Score::Missing(MissingReason::NotLearnt),
                missing @ Score::Missing(_) => missing,
            },
            dead_zone_deviation_rad: deviation,
            effort_nm2s: score(Metric::Effort),
            torque_total_variation_nm: score(Metric::TorqueTotalVariation),
        }
    }

    #[must_use]
    pub const fn get(&self, criterion: Criterion) -> Score {
        match criterion {
            Criterion::SettleTime => self.settle_time_s,
            Criterion::Overshoot => self.overshoot_rad,
            Criterion::StaticError => self.static_error_rad,
            Criterion::StaticErrorInBands => self.static_error_bands,
            Criterion::Hunting => self.hunting_rad,
            Criterion::DeadZoneError => self.dead_zone_error_rad,
            Criterion::LearntDeadZoneError => self.learnt_dead_zone_error_rad,
            Criterion::DeadZoneDeviation => self.dead_zone_deviation_rad,
            Criterion::Effort => self.effort_nm2s,
            Criterion::TorqueVariation => self.torque_total_variation_nm,
        }
    }
}

#[cfg(test)]
mod tests;
