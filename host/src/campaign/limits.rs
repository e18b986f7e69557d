//! Limits of the laws on the random plants.

use std::fmt;

use lashloop_firmware::control::braking_curve::LEARNT_DEVIATION_RAD;
use serde::Serialize;

use super::law::Law;
use super::quantiles::{Quantile, Quantiles};
use super::score::{Criterion, Score};

/// An upper limit on a quantile over the random plants.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    pub law: Law,
    #[serde(rename = "figure")]
    pub criterion: Criterion,
    pub quantile: Quantile,
    /// In SI units; the value itself misses the limit.
    pub below: f64,
}

const fn limit(law: Law, criterion: Criterion, quantile: Quantile, below: f64) -> Limit {
    Limit { law, criterion, quantile, below }
}

/// In the order of [`Law::ALL`].
pub const LIMITS: [Limit; 12] = [
    limit(Law::BACKLASH_INVERSE, Criterion::SettleTime, Quantile::P95, 3.0),
    limit(Law::BACKLASH_INVERSE, Criterion::StaticError, Quantile::Max, 3.5e-3),
    limit(Law::BACKLASH_INVERSE, Criterion::Hunting, Quantile::Max, 1.5e-3),
    limit(Law::BACKLASH_INVERSE, Criterion::DeadZoneError, Quantile::P95, 25e-3),
    limit(Law::BRAKING_CURVE, Criterion::SettleTime, Quantile::P95, 1.4),
    limit(Law::BRAKING_CURVE, Criterion::SettleTime, Quantile::Max, 1.6),
    limit(Law::BRAKING_CURVE, Criterion::Overshoot, Quantile::Max, 5e-3),
    limit(Law::BRAKING_CURVE, Criterion::StaticErrorInBands, Quantile::P99, 1.0),
    limit(Law::BRAKING_CURVE, Criterion::Hunting, Quantile::Max, 0.01e-3),
    limit(Law::BRAKING_CURVE, Criterion::LearntDeadZoneError, Quantile::P95, 25e-3),
    limit(Law::BRAKING_CURVE, Criterion::DeadZoneDeviation, Quantile::P80, LEARNT_DEVIATION_RAD),
    limit(Law::BRAKING_CURVE, Criterion::TorqueVariation, Quantile::P95, 260.0),
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
        let Self { limit: Limit { criterion, quantile, below, .. }, value, met } = self;
        let value = criterion.cell(*value);
        let what = format!("{}, {quantile}", criterion.name());
        let limit = format!("< {} {}", criterion.show(*below), criterion.unit());
        write!(out, "{:<6} {what:<28}{value:>10}   {limit}", if *met { "met" } else { "MISSED" })
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
                MissingReason::NotLearnt,
            ] {
                assert!(!judged(Score::Missing(reason)), "{limit:?}: {reason}");
            }
        }
    }
}
