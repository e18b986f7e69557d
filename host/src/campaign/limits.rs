//! Limits of the backlash inverse on the random plants.

use std::fmt;

use serde::Serialize;

use super::law::Law;
use super::quantiles::{Quantile, Quantiles};
use super::score::{Criterion, Score};

/// The law under these limits.
pub const LAW: Law = Law::WITH_LIMITS;

/// An upper limit on a quantile over the random plants.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    #[serde(rename = "figure")]
    pub criterion: Criterion,
    pub quantile: Quantile,
    /// In the unit of the metric; the value itself misses the limit.
    pub below: f64,
}

pub const LIMITS: [Limit; 4] = [
    Limit { criterion: Criterion::SettleTime, quantile: Quantile::P95, below: 3.0 },
    Limit { criterion: Criterion::StaticError, quantile: Quantile::Max, below: 3.5e-3 },
    Limit { criterion: Criterion::Hunting, quantile: Quantile::Max, below: 1.5e-3 },
    Limit { criterion: Criterion::DeadZoneError, quantile: Quantile::P95, below: 25e-3 },
];

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LimitResult {
    #[serde(flatten)]
    pub limit: Limit,
    pub value: Score,
    pub met: bool,
}

impl Limit {
    #[must_use]
    pub fn judge(self, quantiles: &Quantiles) -> LimitResult {
        let value = quantiles.get(self.quantile);
        LimitResult { limit: self, value, met: value.value().is_some_and(|value| value < self.below) }
    }
}

impl fmt::Display for LimitResult {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { limit: Limit { criterion, quantile, below }, value, met } = self;
        let value = criterion.cell(*value);
        let what = format!("{}, {quantile}", criterion.name());
        let limit = format!("< {} {}", criterion.show(*below), criterion.unit());
        write!(out, "{:<6} {what:<24}{value:>10}   {limit}", if *met { "met" } else { "MISSED" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::score::MissingReason;

    #[test]
    fn limit_is_missed_at_its_value_and_without_a_value() {
        for limit in LIMITS {
            let judged = |score| limit.judge(&Quantiles::of([score]).expect("a run")).met;
            assert!(judged(Score::Value(limit.below * 0.999)), "{limit:?}");
            assert!(judged(Score::Value(-limit.below * 0.999)), "{limit:?}");
            for bad in [limit.below, -limit.below, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert!(!judged(Score::Value(bad)), "{limit:?} at {bad}");
            }
            for reason in [
                MissingReason::Unmeasured,
                MissingReason::Never,
                MissingReason::CutShort,
                MissingReason::NotFinite,
            ] {
                assert!(!judged(Score::Missing(reason)), "{limit:?}: {reason}");
            }
        }
    }
}
