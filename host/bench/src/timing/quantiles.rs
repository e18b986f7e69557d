//! Quantiles from a histogram of fixed size, which allocates only on creation.

use std::time::Duration;

use hdrhistogram::Histogram;
use serde::{Deserialize, Serialize};

/// Longer times are clamped to this; every timeout of the bench is shorter.
const LONGEST: Duration = Duration::from_mins(2);
/// Three significant digits: 0.1 %.
const DIGITS: u8 = 3;

/// A histogram of durations.
#[derive(Debug, Clone)]
pub(super) struct Durations(Histogram<u64>);

impl Durations {
    pub(super) fn new() -> Self {
        let histogram = Histogram::new_with_bounds(1, LONGEST.as_nanos() as u64, DIGITS);
        Self(histogram.expect("bounds and digits are those the library documents as good"))
    }

    pub(super) fn record(&mut self, duration: Duration) {
        self.0.saturating_record(u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX));
    }

    pub(super) fn quantiles(&self) -> Option<Quantiles> {
        if self.0.is_empty() {
            return None;
        }
        let at = |quantile| microseconds(self.0.value_at_quantile(quantile));
        Some(Quantiles { p50: at(0.5), p99: at(0.99), p99_9: at(0.999), max: microseconds(self.0.max()) })
    }

    /// Upper end in microseconds and count of each bin. Each upper end is twice the one before; empty bins at the end are
    /// omitted.
    pub(super) fn bins(&self) -> Vec<(f64, u64)> {
        if self.0.is_empty() {
            return Vec::new();
        }
        let bins = self.0.iter_log(1_000, 2.0);
        bins.map(|bin| (microseconds(bin.value_iterated_to() + 1), bin.count_since_last_iteration()))
            .collect()
    }
}

fn microseconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 / 1e3
}

/// Quantiles of a duration in microseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// Median.
    pub p50: f64,
    /// 99 % quantile.
    pub p99: f64,
    /// 99.9 % quantile.
    pub p99_9: f64,
    /// Maximum.
    pub max: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_to_a_thousand_us() -> Durations {
        let mut durations = Durations::new();
        (1..=1_000).for_each(|us| durations.record(Duration::from_micros(us)));
        durations
    }

    #[test]
    fn quantiles_match_the_recorded_values() {
        let Quantiles { p50, p99, p99_9, max } = one_to_a_thousand_us().quantiles().expect("values");
        for (found, expected) in [(p50, 500.0), (p99, 990.0), (p99_9, 999.0), (max, 1_000.0)] {
            assert!((found / expected - 1.0_f64).abs() < 2e-3, "{found} for {expected}");
        }
    }

    #[test]
    fn an_empty_histogram_has_no_quantiles() {
        assert_eq!(Durations::new().quantiles(), None);
    }

    #[test]
    fn every_value_is_in_one_bin() {
        let bins = one_to_a_thousand_us().bins();
        assert_eq!(bins.iter().map(|(_, count)| count).sum::<u64>(), 1_000);
        assert!(bins.windows(2).all(|pair| pair[1].0 == 2.0 * pair[0].0), "{bins:?}");
    }

    #[test]
    fn a_time_beyond_the_bounds_is_clamped() {
        let mut durations = Durations::new();
        durations.record(Duration::MAX);
        assert!(durations.quantiles().expect("a value").max >= 119e6);
    }
}
