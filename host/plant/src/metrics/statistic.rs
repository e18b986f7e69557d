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

impl Statistic {
    /// Every statistic, in the order of the documentation.
    pub const ALL: [Self; 8] =
        [Self::Min, Self::Max, Self::Mean, Self::Rms, Self::Peak, Self::PeakToPeak, Self::Std, Self::Final];

    /// Name in scenarios and summaries.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Max => "max",
            Self::Mean => "mean",
            Self::Rms => "rms",
            Self::Peak => "peak",
            Self::PeakToPeak => "peak_to_peak",
            Self::Std => "std",
            Self::Final => "final",
        }
    }

    /// Definition over the values v_1 to v_n.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Min => "smallest v",
            Self::Max => "largest v",
            Self::Mean => "sum of v / n",
            Self::Rms => "root of the sum of v^2 / n",
            Self::Peak => "largest abs(v)",
            Self::PeakToPeak => "largest v minus smallest v",
            Self::Std => "root of the sum of (v - mean)^2 / n",
            Self::Final => "v_n",
        }
    }

    /// How its value can change.
    #[must_use]
    pub const fn trend(self) -> Trend {
        match self {
            Self::Max | Self::Peak | Self::PeakToPeak => Trend::Rising,
            Self::Min => Trend::Falling,
            Self::Mean | Self::Rms | Self::Std | Self::Final => Trend::Any,
        }
    }
}

impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A statistic so far.
#[derive(Debug, Clone, Copy)]
enum Accumulator {
    Min(f64),
    Max(f64),
    Mean { sum: f64 },
    Rms { sum_of_squares: f64 },
    Peak(f64),
    PeakToPeak { low: f64, high: f64 },
    Std { mean: f64, squares: f64 },
    Final(f64),
}

impl Accumulator {
    const fn empty(statistic: Statistic) -> Self {
        match statistic {
            Statistic::Min => Self::Min(f64::INFINITY),
            Statistic::Max => Self::Max(f64::NEG_INFINITY),
            Statistic::Mean => Self::Mean { sum: 0.0 },
            Statistic::Rms => Self::Rms { sum_of_squares: 0.0 },
            Statistic::Peak => Self::Peak(0.0),
            Statistic::PeakToPeak => Self::PeakToPeak { low: f64::INFINITY, high: f64::NEG_INFINITY },
            Statistic::Std => Self::Std { mean: 0.0, squares: 0.0 },
            Statistic::Final => Self::Final(f64::NAN),
        }
    }

    /// Adds the value number `count`.
    fn add(&mut self, value: f64, count: f64) {
        match self {
            Self::Min(low) => *low = low.min(value),
            Self::Max(high) => *high = high.max(value),
            Self::Mean { sum } => *sum += value,
            Self::Rms { sum_of_squares } => *sum_of_squares += value * value,
            Self::Peak(peak) => *peak = peak.max(value.abs()),
            Self::PeakToPeak { low, high } => (*low, *high) = (low.min(value), high.max(value)),
            // Welford's recurrence: a large mean doesn't cancel a small deviation.
            Self::Std { mean, squares } => {
                let before = value - *mean;
                *mean += before / count;
                *squares += before * (value - *mean);
            }
            Self::Final(last) => *last = value,
        }
    }

    /// The statistic of `count` values, at least 1.
    fn of(self, count: f64) -> f64 {
        match self {
            Self::Min(value) | Self::Max(value) | Self::Peak(value) | Self::Final(value) => value,
            Self::Mean { sum } => sum / count,
            Self::Rms { sum_of_squares } => (sum_of_squares / count).sqrt(),
            Self::PeakToPeak { low, high } => high - low,
            Self::Std { squares, .. } => (squares / count).sqrt(),
        }
    }
}

/// A statistic of a channel.
#[derive(Debug)]
pub(super) struct StatisticMeter {
    channel: Channel,
    count: f64,
    accumulator: Accumulator,
    /// Latched, because comparisons drop NaN.
    finite: bool,
}

impl StatisticMeter {
    pub(super) const fn new(channel: Channel, statistic: Statistic) -> Self {
        Self { channel, count: 0.0, accumulator: Accumulator::empty(statistic), finite: true }
    }
}

impl Meter for StatisticMeter {
    fn push(&mut self, sample: &Sample<'_>) {
        let Some(value) = self.channel.of(sample) else { return };
        self.finite &= value.is_finite();
        self.count += 1.0;
        self.accumulator.add(value, self.count);
    }

    fn measured(&self) -> Measured {
        if self.count == 0.0 {
            return Measured::NoTelemetry;
        }
        if !self.finite {
            return Measured::NotFinite;
        }
        Measured::finite(self.accumulator.of(self.count))
    }
}
