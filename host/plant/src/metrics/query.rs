//! What a scenario asks of a run beyond the metrics of the whole run.

use super::metric::Metric;
use super::statistic::Statistic;

/// A quantity that a run can be judged by.
#[derive(Debug, Clone, PartialEq)]
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Start, in time of the run.
    pub from_s: f64,
    /// End, in time of the run; `None` for that of the run.
    pub to_s: Option<f64>,
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
