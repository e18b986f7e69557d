//! Quantiles over runs, some of which may have no value.
//!
//! Nearest rank: the q-quantile of n runs is the ceil(q n)-th best score. Without interpolation a quantile is the score of one
//! run. Missing values are included, so a run that never settled is the maximum. Only a value of a gap that does not count
//! as learnt ([`MissingReason::NotLearnt`]) is omitted, unless no run has another.

use serde::Serialize;

use super::score::{MissingReason, Score};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantile {
    /// Half of the runs score no worse.
    Median,
    /// 80 % of the runs score no worse, and so on.
    P80,
    P95,
    P99,
    Max,
}

impl Quantile {
    /// The columns of the tables. The others are for limits.
    pub const SHOWN: [Self; 3] = [Self::Median, Self::P95, Self::Max];

    /// Rank among `runs`, from 1. In integers, because 0.95 n in floating point can round up to the next rank.
    const fn rank(self, runs: usize) -> usize {
        match self {
            Self::Median => runs.div_ceil(2),
            Self::P80 => (runs * 4).div_ceil(5),
            Self::P95 => (runs * 19).div_ceil(20),
            Self::P99 => (runs * 99).div_ceil(100),
            Self::Max => runs,
        }
    }
}

/// Quantiles of the magnitude of a score.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantiles {
    median: Score,
    p80: Score,
    p95: Score,
    p99: Score,
    max: Score,
}

impl Quantiles {
    /// `None` without a run.
    #[must_use]
    pub fn of(scores: impl IntoIterator<Item = Score>) -> Option<Self> {
        let mut sizes: Vec<_> = scores.into_iter().map(Score::magnitude).collect();
        let learnt = |size: &Score| *size != Score::Missing(MissingReason::NotLearnt);
        if sizes.iter().any(learnt) {
            sizes.retain(learnt);
        }
        sizes.sort_by(Score::order);
        let at = |quantile: Quantile| sizes.get(quantile.rank(sizes.len()).checked_sub(1)?).copied();
        Some(Self {
            median: at(Quantile::Median)?,
            p80: at(Quantile::P80)?,
            p95: at(Quantile::P95)?,
            p99: at(Quantile::P99)?,
            max: at(Quantile::Max)?,
        })
    }

    #[must_use]
    pub const fn get(&self, quantile: Quantile) -> Score {
        match quantile {
            Quantile::Median => self.median,
            Quantile::P80 => self.p80,
            Quantile::P95 => self.p95,
            Quantile::P99 => self.p99,
            Quantile::Max => self.max,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::score::MissingReason;

    #[test]
    fn quantiles_are_scores_of_runs_by_nearest_rank() {
        let spread = |runs: u32| Quantiles::of((1..=runs).rev().map(|n| Score::Value(n.into())));
        let ranks = |runs| Quantile::SHOWN.map(|it| spread(runs).expect("runs").get(it).value());
        assert_eq!(ranks(1), [Some(1.0); 3]);
        assert_eq!(ranks(20), [Some(10.0), Some(19.0), Some(20.0)]);
        assert_eq!(ranks(200), [Some(100.0), Some(190.0), Some(200.0)]);
        let of_limits =
            |runs| [Quantile::P80, Quantile::P99].map(|it| spread(runs).expect("runs").get(it).value());
        assert_eq!(of_limits(200), [Some(160.0), Some(198.0)]);
        assert_eq!(of_limits(20), [Some(16.0), Some(20.0)]);
        assert_eq!(spread(0), None);
    }

    #[test]
    fn diverged_run_counts_in_every_quantile() {
        let runs = |bad: usize| {
            let good = [Score::Value(-1.0)].into_iter().cycle().take(20 - bad);
            let all = [Score::Missing(MissingReason::NotFinite)].into_iter().cycle().take(bad).chain(good);
            let spread = Quantiles::of(all).expect("runs");
            Quantile::SHOWN.map(|it| spread.get(it).value())
        };
        assert_eq!(runs(0), [Some(1.0); 3]);
        assert_eq!(runs(1), [Some(1.0), Some(1.0), None]);
        assert_eq!(runs(2), [Some(1.0), None, None]);
        assert_eq!(runs(11), [None; 3]);
    }
}
