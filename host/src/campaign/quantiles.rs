//! Quantiles over runs of which some may have no figure.
//!
//! By nearest rank: the q-quantile of n runs is the figure of the ceil(q n)-th best. Nothing is interpolated, so a quantile is
//! the figure of a run, and nothing is dropped, so a run that never settled is the maximum of its figure.

use serde::Serialize;

use super::score::Score;

/// Which quantile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Quantile {
    /// Half of the runs are no worse.
    Median,
    /// 95 % of the runs are.
    P95,
    /// All are.
    Max,
}

impl Quantile {
    /// Every quantile, in the order of the tables.
    pub const ALL: [Self; 3] = [Self::Median, Self::P95, Self::Max];

    /// Name in a table.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Median => "median",
            Self::P95 => "p95",
            Self::Max => "max",
        }
    }

    /// The rank of the quantile among so many runs, from 1. In whole numbers, for 0.95 n is not always what it looks like.
    const fn rank(self, runs: usize) -> usize {
        match self {
            Self::Median => runs.div_ceil(2),
            Self::P95 => (runs * 19).div_ceil(20),
            Self::Max => runs,
        }
    }
}

/// Median, 95 % quantile and maximum of the size of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantiles {
    median: Score,
    p95: Score,
    max: Score,
}

impl Quantiles {
    /// The quantiles of these runs; `None` without any run.
    #[must_use]
    pub fn of(scores: impl IntoIterator<Item = Score>) -> Option<Self> {
        let mut sizes: Vec<_> = scores.into_iter().map(Score::size).collect();
        sizes.sort_by(Score::order);
        let at = |quantile: Quantile| sizes.get(quantile.rank(sizes.len()).checked_sub(1)?).copied();
        Some(Self { median: at(Quantile::Median)?, p95: at(Quantile::P95)?, max: at(Quantile::Max)? })
    }

    /// One of them.
    #[must_use]
    pub const fn get(&self, quantile: Quantile) -> Score {
        match quantile {
            Quantile::Median => self.median,
            Quantile::P95 => self.p95,
            Quantile::Max => self.max,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::score::MissingReason;

    #[test]
    fn quantiles_are_figures_of_runs_by_nearest_rank() {
        let spread = |runs: u32| Quantiles::of((1..=runs).rev().map(|n| Score::Value(n.into())));
        let ranks = |runs| Quantile::ALL.map(|it| spread(runs).expect("runs").get(it).value());
        assert_eq!(ranks(1), [Some(1.0); 3]);
        assert_eq!(ranks(20), [Some(10.0), Some(19.0), Some(20.0)]);
        assert_eq!(ranks(200), [Some(100.0), Some(190.0), Some(200.0)]);
        assert_eq!(spread(0), None);
    }

    #[test]
    fn a_run_that_diverged_is_in_every_quantile_it_belongs_to() {
        let runs = |bad: usize| {
            let good = [Score::Value(-1.0)].into_iter().cycle().take(20 - bad);
            let all = [Score::Missing(MissingReason::NotFinite)].into_iter().cycle().take(bad).chain(good);
            let spread = Quantiles::of(all).expect("runs");
            Quantile::ALL.map(|it| spread.get(it).value())
        };
        assert_eq!(runs(0), [Some(1.0); 3]);
        assert_eq!(runs(1), [Some(1.0), Some(1.0), None]);
        assert_eq!(runs(2), [Some(1.0), None, None]);
        assert_eq!(runs(11), [None; 3]);
    }
}
