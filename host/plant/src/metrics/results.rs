//! What a measurement yields.

use super::measured::Measured;
use super::metric::Metric;
use super::query::{Quantity, Query};
use super::signal_table::DRIVE_PREFIX;

/// All metrics of one run, and the answers to its queries.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    pub(super) values: [Measured; Metric::ALL.len()],
    pub(super) answers: Vec<(Query, Measured)>,
    pub(super) finite: bool,
}

impl Metrics {
    /// One metric over the whole run.
    #[must_use]
    pub const fn get(&self, metric: Metric) -> Measured {
        self.values[metric as usize]
    }

    /// The metrics of a run without a simulated plant: what needs a signal of the plant has no truth to be compared with.
    #[must_use]
    pub fn without_truth(mut self) -> Self {
        for measured in &mut self.values {
            if matches!(measured, Measured::MissingSignal(name) if !name.starts_with(DRIVE_PREFIX)) {
                *measured = Measured::NoTruth;
            }
        }
        self
    }

    /// The answer to a query: [`Measured::NotMeasured`] unless it is a metric over the whole run, or was given to the
    /// measurement.
    #[must_use]
    pub fn answer(&self, query: &Query) -> Measured {
        if let Query { quantity: Quantity::Metric(metric), window: None } = query {
            return self.get(*metric);
        }
        let answer = self.answers.iter().find(|(asked, _)| asked == query);
        answer.map_or(Measured::NotMeasured, |(_, measured)| *measured)
    }

    /// Whether every position, reference and torque of the run was finite.
    #[must_use]
    pub const fn run_was_finite(&self) -> bool {
        self.finite
    }

    /// Every metric with its value, in the order of reports.
    pub fn iter(&self) -> impl Iterator<Item = (Metric, Measured)> {
        Metric::ALL.into_iter().zip(self.values)
    }
}
