//! Metrics computed sample by sample. Memory is bounded by the windows of the metrics, and no sample allocates.

use std::ops::Range;

use super::measured::Measured;
use super::meter::NewMeter;
use super::metric::Metric;
use super::plan::Plan;
use super::query::{Quantity, Query};
use super::results::Metrics;
use super::sample::Sample;
use super::signal_table::SignalTable;

/// Computes the metrics of one run, and the answers to its queries, from its samples.
#[derive(Debug)]
pub struct Measurement {
    /// Latched, because comparisons drop NaN.
    finite: bool,
    samples: u32,
    metrics: [NewMeter; Metric::ALL.len()],
    queries: Vec<Probe>,
}

/// The meter of one query.
#[derive(Debug)]
struct Probe {
    query: Query,
    samples: Range<u32>,
    /// Number of samples of the run without which there is no answer.
    least: u32,
    meter: NewMeter,
}

impl Measurement {
    /// Measures a run of unknown length and reference: metrics that depend on either have no value.
    #[must_use]
    pub fn new(period_s: f64, signals: &SignalTable) -> Self {
        Self::of_run(&Plan { period_s, steps: u32::MAX, reference: None, signals }, [])
    }

    /// Measures a run as planned. A query of a metric over the whole run needs no place in `queries`.
    #[must_use]
    pub fn of_run(plan: &Plan<'_>, queries: impl IntoIterator<Item = Query>) -> Self {
        let probe = |query: Query| {
            let samples = plan.samples(&query);
            let ends_early = query.window.is_some_and(|window| window.to_s.is_some());
            let least = if ends_early { samples.end } else { samples.start.saturating_add(1) };
            Probe { meter: plan.meter(&query), samples, least, query }
        };
        let is_extra =
            |query: &Query| query.window.is_some() || !matches!(query.quantity, Quantity::Metric(_));
        Self {
            finite: true,
            samples: 0,
            metrics: Metric::ALL.map(|metric| plan.meter(&metric.into())),
            queries: queries.into_iter().filter(is_extra).map(probe).collect(),
        }
    }

    /// Marks a run whose plant could not be integrated to the end, though every sample was finite: no metric has a value.
    pub fn diverged(&mut self) {
        self.finite = false;
    }

    /// Adds the next sample, in the order of time, one per period.
    pub fn push(&mut self, sample: &Sample<'_>) {
        let index = self.samples;
        self.samples += 1;
        let error_rad = sample.load_position_rad - sample.reference_rad;
        self.finite &= error_rad.is_finite() && sample.torque_nm.is_finite() && sample.time_s.is_finite();
        if !self.finite {
            return;
        }
        for meter in self.metrics.iter_mut().flatten() {
            meter.push(sample);
        }
        for Probe { samples, meter, .. } in &mut self.queries {
            if let Ok(meter) = meter
                && samples.contains(&index)
            {
                meter.push(sample);
            }
        }
    }

    /// The metrics of the samples so far.
    #[must_use]
    pub fn metrics(&self) -> Metrics {
        let values = self.metrics.each_ref().map(|meter| self.measured(meter, 1));
        let answers = self
            .queries
            .iter()
            .map(|Probe { query, meter, least, .. }| (query.clone(), self.measured(meter, *least)));
        Metrics { values, answers: answers.collect(), finite: self.finite }
    }

    /// `least` is the number of samples without which there is no value.
    fn measured(&self, meter: &NewMeter, least: u32) -> Measured {
        match meter {
            _ if !self.finite => Measured::NotFinite,
            Err(reason) => *reason,
            Ok(_) if self.samples < least => Measured::RunTooShort,
            Ok(meter) => meter.measured(),
        }
    }
}

#[cfg(test)]
mod estimate_tests;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod query_tests;
#[cfg(test)]
mod tests;
