//! Statistics of a signal over the samples that have it.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::channel::Channel;
use super::measured::Measured;
use super::meter::Meter;
use super::sample::Sample;
use super::trend::Trend;

/// A statistic of a signal, in the signal's unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// Smallest value.
    Min,
    /// Largest value.
    Max,
    /// Arithmetic mean.
    Mean,
    /// Root of the mean square.
    Rms,
    /// Largest amount.
    Peak,
    /// Largest value minus smallest value.
    PeakToPeak,
    /// Standard deviation: root of the mean square of the distance from the mean.
    Std,
    /// Last value.
    Final,
}

/// Name, definition over the values v_1 to v_n, and trend, in the order of the variants.
const FACTS: [(&str, &str, Trend); Statistic::ALL.len()] = [
    ("min", "smallest v", Trend::Falling),
    ("max", "largest v", Trend::Rising),
    ("mean", "sum of v / n", Trend::Any),
    ("rms", "root of the sum of v^2 / n", Trend::Any),
    ("peak", "largest abs(v)", Trend::Rising),
    ("peak_to_peak", "largest v minus smallest v", Trend::Rising),
    ("std", "root of the sum of (v - mean)^2 / n", Trend::Any),
    ("final", "v_n", Trend::Any),
];

const _: () = {
    let mut at = 0;
    while at < Statistic::ALL.len() {
        assert!(Statistic::ALL[at] as usize == at, "FACTS and ALL are in the order of the variants");
        at += 1;
    }
};

impl Statistic {
    /// Every statistic, in the order of the documentation.
    pub const ALL: [Self; 8] =
        [Self::Min, Self::Max, Self::Mean, Self::Rms, Self::Peak, Self::PeakToPeak, Self::Std, Self::Final];

    /// Name in scenarios and summaries.
    #[must_use]
    pub const fn name(self) -> &'static str {
        FACTS[self as usize].0
    }

    /// Definition over the values v_1 to v_n.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        FACTS[self as usize].1
    }

    /// How its value can change.
    #[must_use]
    pub const fn trend(self) -> Trend {
        FACTS[self as usize].2
    }
}

impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A statistic of a channel: what any statistic needs of the values so far.
#[derive(Debug)]
pub(super) struct StatisticMeter {
    channel: Channel,
    statistic: Statistic,
    count: f64,
    low: f64,
    high: f64,
    sum: f64,
    sum_of_squares: f64,
    mean: f64,
    /// Sum of the squared distances from the mean.
    squares: f64,
    last: f64,
    /// Latched, because comparisons drop NaN.
    finite: bool,
}

impl StatisticMeter {
    pub(super) const fn new(channel: Channel, statistic: Statistic) -> Self {
        let [count, sum, sum_of_squares, mean, squares, last] = [0.0; 6];
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { channel, statistic, count, low, high, sum, sum_of_squares, mean, squares, last, finite: true }
    }
}

impl Meter for StatisticMeter {
    fn push(&mut self, sample: &Sample<'_>) {
        let Some(value) = self.channel.of(sample) else { return };
        self.finite &= value.is_finite();
        self.count += 1.0;
        (self.low, self.high, self.last) = (self.low.min(value), self.high.max(value), value);
        self.sum += value;
        self.sum_of_squares += value * value;
        if self.statistic == Statistic::Std {
            // Welford's recurrence: a large mean doesn't cancel a small deviation.
            let before = value - self.mean;
            self.mean += before / self.count;
            self.squares += before * (value - self.mean);
        }
    }

    fn measured(&self) -> Measured {
        if self.count == 0.0 {
            return Measured::NoTelemetry;
        }
        if !self.finite {
            return Measured::NotFinite;
        }
        Measured::finite(match self.statistic {
            Statistic::Min => self.low,
            Statistic::Max => self.high,
            Statistic::Mean => self.sum / self.count,
            Statistic::Rms => (self.sum_of_squares / self.count).sqrt(),
            // The amount of a signal that is -0 throughout is 0.
            Statistic::Peak => self.high.max(-self.low).abs(),
            Statistic::PeakToPeak => self.high - self.low,
            Statistic::Std => (self.squares / self.count).sqrt(),
            Statistic::Final => self.last,
        })
    }
}
