//! Quantiles over runs by nearest rank, of which some have no value.
//!
//! The q-quantile of n runs is the ceil(q n)-th best. Without interpolation it is the number of one run. A run without a value
//! ranks behind every number. Only runs that a derived column omits don't count, unless it omits all.

use std::collections::BTreeMap;

use crate::cell::{Cell, Missing};

/// Sorted magnitudes of a column over runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Sorted {
    values: Vec<f64>,
    /// By [`Missing::ALL`].
    missing: [u64; Missing::ALL.len()],
}

impl Sorted {
    /// Magnitudes in any order, and the numbers of runs without a value.
    #[must_use]
    pub fn new(mut values: Vec<f64>, missing: [u64; Missing::ALL.len()]) -> Self {
        for value in &mut values {
            *value = value.abs();
        }
        values.sort_unstable_by(f64::total_cmp);
        let mut sorted = Self { values, missing };
        let omitted = sorted.missing[Missing::Omitted as usize];
        if omitted < sorted.len() {
            sorted.missing[Missing::Omitted as usize] = 0;
        }
        sorted
    }

    /// The runs of several columns together.
    #[must_use]
    pub fn union(parts: &[&Self]) -> Self {
        let mut missing = [0; Missing::ALL.len()];
        for part in parts {
            missing.iter_mut().zip(part.missing).for_each(|(sum, count)| *sum += count);
        }
        Self::new(parts.iter().flat_map(|part| part.values.iter().copied()).collect(), missing)
    }

    /// Runs without a value, by reason.
    #[must_use]
    pub fn missing(&self) -> BTreeMap<&'static str, u64> {
        let counts = Missing::ALL.into_iter().map(|reason| (reason.word(), self.missing[reason as usize]));
        counts.filter(|(_, count)| *count > 0).collect()
    }

    /// Runs that count.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.values.len() as u64 + self.missing.iter().sum::<u64>()
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Values in ascending order; runs without a value rank behind them.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The run at a rank, from 1; `None` beyond the last.
    #[must_use]
    pub fn at_rank(&self, rank: u64) -> Option<Cell> {
        let index = rank.checked_sub(1)?;
        if let Some(value) = self.values.get(usize::try_from(index).ok()?) {
            return Some(Cell::Value(*value));
        }
        let mut behind = index - self.values.len() as u64;
        for reason in Missing::ALL {
            let count = self.missing[reason as usize];
            if behind < count {
                return Some(Cell::Missing(reason));
            }
            behind -= count;
        }
        None
    }

    /// The quantile; `None` without a run.
    #[must_use]
    pub fn quantile(&self, quantile: f64) -> Option<Cell> {
        self.at_rank(rank(quantile, self.len()))
    }
}

/// Rank of a quantile among `runs`, from 1. In millionths, because 0.95 n in floating point can exceed the rank.
#[must_use]
pub fn rank(quantile: f64, runs: u64) -> u64 {
    const PARTS: u64 = 1_000_000;
    let parts = (quantile * PARTS as f64).round() as u64;
    (parts * runs).div_ceil(PARTS).clamp(1, runs.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(values: impl IntoIterator<Item = f64>, missing: Missing, count: u64) -> Sorted {
        let mut counts = [0; Missing::ALL.len()];
        counts[missing as usize] = count;
        Sorted::new(values.into_iter().collect(), counts)
    }

    #[test]
    fn quantiles_are_numbers_of_runs_by_nearest_rank() {
        let at = |runs: u32, quantile| {
            let all = sorted((1..=runs).rev().map(f64::from), Missing::Never, 0);
            all.quantile(quantile).and_then(Cell::value)
        };
        assert_eq!([0.5, 0.95, 1.0].map(|quantile| at(1, quantile)), [Some(1.0); 3]);
        assert_eq!([0.5, 0.95, 1.0].map(|quantile| at(20, quantile)), [Some(10.0), Some(19.0), Some(20.0)]);
        assert_eq!([0.8, 0.99].map(|quantile| at(200, quantile)), [Some(160.0), Some(198.0)]);
        assert_eq!(at(0, 0.5), None);
        assert_eq!(rank(0.95, 10_000_000), 9_500_000);
    }

    #[test]
    fn diverged_run_counts_in_every_quantile() {
        let quantiles = |bad: u64| {
            let all = sorted(vec![-1.0; 20 - bad as usize], Missing::NotFinite, bad);
            [0.5, 0.95, 1.0].map(|quantile| all.quantile(quantile).and_then(Cell::value))
        };
        assert_eq!(quantiles(0), [Some(1.0); 3]);
        assert_eq!(quantiles(1), [Some(1.0), Some(1.0), None]);
        assert_eq!(quantiles(2), [Some(1.0), None, None]);
        assert_eq!(quantiles(11), [None; 3]);
    }

    #[test]
    fn omitted_runs_do_not_count_unless_all_are_omitted() {
        assert_eq!(sorted([0.1], Missing::Omitted, 9).quantile(1.0), Some(Cell::Value(0.1)));
        assert_eq!(sorted([], Missing::Omitted, 9).quantile(0.5), Some(Cell::Missing(Missing::Omitted)));
    }
}
