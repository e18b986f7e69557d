//! The numbers of one run: metrics and derived columns, each a value or the reason for its absence.

use std::cmp::Ordering;
use std::f64::consts::TAU;
use std::fmt;

use lashloop_bench::run::{End, Outcome};
use lashloop_bench::verdict::Verdict;
use lashloop_plant::metrics::{Measured, Metric, Metrics};
use serde::{Serialize, Serializer};

use crate::settings::{Derived, Divisor};

/// A number of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell {
    /// Finite, in the unit of the metric.
    Value(f64),
    Missing(Missing),
}

/// Why there is no number, from the least to the most severe reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Missing {
    /// The metric does not apply to this run.
    Unmeasured,
    /// The condition of the derived column does not hold.
    Omitted,
    /// The load never settled.
    Never,
    /// The run ended early or is INVALID: what was measured does not describe the run.
    CutShort,
    /// A value was not finite, or the plant could not be integrated.
    NotFinite,
}

impl Missing {
    pub const ALL: [Self; 5] =
        [Self::Unmeasured, Self::Omitted, Self::Never, Self::CutShort, Self::NotFinite];

    /// The word in tables.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Unmeasured => "none",
            Self::Omitted => "omitted",
            Self::Never => "never",
            Self::CutShort => "cut short",
            Self::NotFinite => "not finite",
        }
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(self.word())
    }
}

impl Cell {
    /// Reads a field of a table; `None` if it is neither a finite number nor a reason.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        match text.parse() {
            Ok(value) => f64::is_finite(value).then_some(Self::Value(value)),
            Err(_) => Missing::ALL.into_iter().find(|reason| reason.word() == text).map(Self::Missing),
        }
    }

    #[must_use]
    pub const fn value(self) -> Option<f64> {
        if let Self::Value(value) = self { Some(value) } else { None }
    }

    #[must_use]
    pub const fn magnitude(self) -> Self {
        match self {
            Self::Value(value) => Self::Value(value.abs()),
            Self::Missing(_) => self,
        }
    }

    /// Orders by value, best first. A missing value ranks behind every number.
    #[must_use]
    pub fn order(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Value(one), Self::Value(other)) => one.total_cmp(other),
            (Self::Value(_), Self::Missing(_)) => Ordering::Less,
            (Self::Missing(_), Self::Value(_)) => Ordering::Greater,
            (Self::Missing(one), Self::Missing(other)) => one.cmp(other),
        }
    }
}

/// A number, or the reason as a text.
impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Value(value) => serializer.serialize_f64(*value),
            Self::Missing(reason) => serializer.serialize_str(reason.word()),
        }
    }
}

/// What the derived columns take from a case.
pub trait CaseNumbers {
    /// The value of a key.
    fn number(&self, key: &str) -> Option<f64>;

    /// A quantity of the run.
    fn quantity(&self, divisor: Divisor) -> Option<f64>;
}

/// The numbers of a run: every metric, then the derived columns.
#[must_use]
pub fn cells(outcome: &Outcome, derived: &[Derived], case: &impl CaseNumbers) -> Vec<Cell> {
    judged(&outcome.end, outcome.judgement.verdict, &outcome.metrics, derived, case)
}

fn judged(
    end: &End,
    verdict: Verdict,
    metrics: &Metrics,
    derived: &[Derived],
    case: &impl CaseNumbers,
) -> Vec<Cell> {
    let cell = |metric: Metric| match (end, metrics.get(metric)) {
        (End::Diverged(_), _) | (_, Measured::NotFinite) => Cell::Missing(Missing::NotFinite),
        (
            End::DriveFault(_)
            | End::RuleBroken(_)
            | End::DriveRestarted
            | End::BeyondTravel { .. }
            | End::Interrupted,
            _,
        ) => Cell::Missing(Missing::CutShort),
        _ if verdict == Verdict::Invalid => Cell::Missing(Missing::CutShort),
        (End::Complete, Measured::Value(value)) => Cell::Value(value),
        (End::Complete, Measured::Never) => Cell::Missing(Missing::Never),
        (End::Complete, _) => Cell::Missing(Missing::Unmeasured),
    };
    let derive = |derived: &Derived| {
        if let Some((condition, at_most)) = derived.only_if {
            match cell(condition) {
                Cell::Value(value) if value <= at_most => {}
                Cell::Value(_) => return Cell::Missing(Missing::Omitted),
                missing @ Cell::Missing(_) => return missing,
            }
        }
        let over = match derived.over.map(|divisor| case.quantity(divisor)) {
            None => 1.0,
            Some(Some(over)) if over > 0.0 => over,
            Some(_) => return Cell::Missing(Missing::Unmeasured),
        };
        let count_rad =
            derived.or_count_of.as_deref().and_then(|key| case.number(key)).map(|counts| TAU / counts);
        let per = match (derived.per, count_rad) {
            (Some(per), count) => per.max(count.unwrap_or(per)),
            (None, count) => count.unwrap_or(1.0),
        };
        match cell(derived.metric) {
            Cell::Value(value) => Cell::Value(value / per / over),
            missing @ Cell::Missing(_) => missing,
        }
    };
    Metric::ALL.iter().map(|metric| cell(*metric)).chain(derived.iter().map(derive)).collect()
}

#[cfg(test)]
mod tests;
