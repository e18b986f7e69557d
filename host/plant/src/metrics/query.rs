//! What a scenario asks of a run beyond the metrics of the whole run.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::metric::Metric;
use super::statistic::Statistic;
use super::trend::Trend;

/// A quantity that a run can be judged by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Keys", into = "Keys")]
pub enum Quantity {
    /// A metric.
    Metric(Metric),
    /// A statistic of a signal, in the signal's unit.
    Statistic {
        /// Name of a fixed signal, of a plant's signal, or `drive.NAME`.
        signal: String,
        /// The statistic.
        statistic: Statistic,
    },
}

/// A part of a run: the samples from one time up to another, which is not included.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Start, in time of the run.
    pub from_s: f64,
    /// End, in time of the run; `None` for that of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_s: Option<f64>,
}

impl Quantity {
    /// How its value can change while the run continues.
    #[must_use]
    pub const fn trend(&self) -> Trend {
        match self {
            Self::Metric(metric) => metric.trend(),
            Self::Statistic { statistic, .. } => statistic.trend(),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Metric(metric) => metric.fmt(f),
            Self::Statistic { signal, statistic } => write!(f, "{statistic} of {signal}"),
        }
    }
}

/// A quantity as the keys of a file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Keys {
    Metric { metric: Metric },
    Statistic { signal: String, statistic: Statistic },
}

impl From<Keys> for Quantity {
    fn from(keys: Keys) -> Self {
        match keys {
            Keys::Metric { metric } => Self::Metric(metric),
            Keys::Statistic { signal, statistic } => Self::Statistic { signal, statistic },
        }
    }
}

impl From<Quantity> for Keys {
    fn from(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Metric(metric) => Self::Metric { metric },
            Quantity::Statistic { signal, statistic } => Self::Statistic { signal, statistic },
        }
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.to_s {
            Some(to_s) => write!(f, "{} s to {to_s} s", self.from_s),
            None => write!(f, "{} s to the end", self.from_s),
        }
    }
}

/// A quantity over the whole run or over one window.
#[derive(Debug, Clone, PartialEq)]
pub struct Query {
    /// What to measure.
    pub quantity: Quantity,
    /// The samples to measure; `None` for the whole run.
    pub window: Option<Window>,
}

impl From<Metric> for Query {
    fn from(metric: Metric) -> Self {
        Self { quantity: Quantity::Metric(metric), window: None }
    }
}
