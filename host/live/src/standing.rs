//! The verdict so far: the expectations that are decided before the end of a run.
//!
//! An expectation is decided if no further sample can change it: its window is over, or its quantity only rises and is
//! beyond its bound. A run that diverges later still takes the value from every expectation.

use std::fmt;

use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::expectation::Expectation;
use lashloop_bench::timing::{ClockName, TimingReport};
use lashloop_bench::verdict::{Breach, JudgedExpectation, Judgement, LinkCounts, Verdict};
use lashloop_plant::metrics::{Measured, Metrics, Trend};
use serde::Serialize;

/// The state of an expectation during a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Standing {
    /// Met, and decided.
    Met,
    /// Missed, and decided.
    Missed,
    /// Within its bounds now.
    Within,
    /// Beyond its bounds now.
    Beyond,
    /// Without a value now.
    Open,
}

/// An expectation with its present value.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub judged: JudgedExpectation,
    pub standing: Standing,
}

/// `steps` of `period_s` have been measured.
fn standing(expectation: &Expectation, judged: &JudgedExpectation, steps: u64, period_s: f64) -> Standing {
    let trend = expectation.quantity.trend();
    let over = |to_s: f64| steps as f64 >= (to_s / period_s).round();
    let is_over = expectation.window.and_then(|window| window.to_s).is_some_and(over);
    let Some(value) = judged.value.value() else {
        let from_s = expectation.window.map_or(0.0, |window| window.from_s);
        let is_late = |max: f64| steps as f64 * period_s - from_s > max;
        let never_in_time = trend == Trend::Settling
            && judged.value == Measured::Never
            && expectation.max.is_some_and(is_late);
        let is_lost = is_over || never_in_time || judged.value == Measured::NotFinite;
        return if is_lost { Standing::Missed } else { Standing::Open };
    };
    let is_above = expectation.max.is_some_and(|max| value > max);
    let is_below = expectation.min.is_some_and(|min| value < min);
    let is_decided = is_over
        || match trend {
            Trend::Rising => is_above || (expectation.max.is_none() && !is_below),
            Trend::Settling => is_above,
            Trend::Falling => is_below || (expectation.min.is_none() && !is_above),
            Trend::Fixed => true,
            Trend::Any => false,
        };
    match (is_decided, judged.ok) {
        (true, true) => Standing::Met,
        (true, false) => Standing::Missed,
        (false, true) => Standing::Within,
        (false, false) => Standing::Beyond,
    }
}

/// The expectations and limits of a run that has not ended.
#[derive(Debug, Clone, PartialEq)]
pub struct SoFar {
    pub rows: Vec<Row>,
    /// Limits that are broken, and decided: counts only rise.
    pub breaches: Vec<Breach>,
}

impl SoFar {
    /// Judges the first `steps` steps of a run. Damaged frames and resumes are counted at the end only.
    #[must_use]
    pub fn new(scenario: &Scenario, metrics: &Metrics, timing: &TimingReport, steps: u64) -> Self {
        let allow = &scenario.allow;
        let Judgement { expectations, mut breaches, .. } =
            Judgement::new(&scenario.expectations, metrics, allow, &LinkCounts::default(), timing);
        breaches.retain(|breach| matches!(&*breach.what, "late" | "late_in_a_row"));
        let allowed = allow.lost.saturating_add(allow.late);
        if timing.clock == ClockName::Lockstep && timing.unanswered > allowed {
            breaches.push(Breach { what: "lost".into(), counted: Some(timing.unanswered), allowed });
        }
        let period_s = scenario.run.control_period_s();
        let rows = scenario.expectations.iter().zip(expectations).map(|(expectation, judged)| Row {
            standing: standing(expectation, &judged, steps, period_s),
            judged,
        });
        Self { rows: rows.collect(), breaches }
    }

    /// The verdict that no further step can improve; `None` while PASS is possible.
    #[must_use]
    pub fn decided(&self) -> Option<Verdict> {
        if !self.breaches.is_empty() {
            return Some(Verdict::Invalid);
        }
        self.rows.iter().any(|row| row.standing == Standing::Missed).then_some(Verdict::Fail)
    }
}

impl fmt::Display for SoFar {
    /// One phrase for a line of progress.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(breach) = self.breaches.first() {
            return write!(f, "{breach}");
        }
        if let Some(Row { judged, .. }) = self.rows.iter().find(|row| row.standing == Standing::Missed) {
            return write!(f, "{judged}");
        }
        let is_met = |row: &&Row| matches!(row.standing, Standing::Met | Standing::Within);
        match self.rows.len() {
            0 => f.write_str("no expectations"),
            count => write!(f, "{} of {count} expectations met", self.rows.iter().filter(is_met).count()),
        }
    }
}

#[cfg(test)]
mod tests {
    use lashloop_plant::metrics::{Metric, Quantity, Query, Statistic, Window};

    use super::*;

    fn judged(expectation: &Expectation, value: Measured) -> JudgedExpectation {
        let within = |value: f64| {
            expectation.min.is_none_or(|min| value >= min) && expectation.max.is_none_or(|max| value <= max)
        };
        JudgedExpectation {
            quantity: expectation.quantity.clone(),
            window: expectation.window,
            value,
            reason: value.reason(),
            unit: expectation.unit.clone(),
            min: expectation.min,
            max: expectation.max,
            ok: value.value().is_some_and(within),
        }
    }

    fn after(expectation: &Expectation, value: Measured, steps: u64) -> Standing {
        standing(expectation, &judged(expectation, value), steps, 1e-3)
    }

    #[test]
    fn a_peak_beyond_its_bound_is_decided_and_a_mean_is_not() {
        let peak = Expectation::of_metric(Metric::PeakTorque, None, Some(5.0));
        assert_eq!(after(&peak, Measured::Value(5.1), 100), Standing::Missed);
        assert_eq!(after(&peak, Measured::Value(4.9), 100), Standing::Within);
        let least = Expectation::of_metric(Metric::PeakTorque, Some(1.0), None);
        assert_eq!(after(&least, Measured::Value(1.1), 100), Standing::Met);
        assert_eq!(after(&least, Measured::Value(0.9), 100), Standing::Beyond);
        let rms = Expectation::of_metric(Metric::RmsTorque, None, Some(5.0));
        assert_eq!(after(&rms, Measured::Value(5.1), 100), Standing::Beyond);
    }

    #[test]
    fn settling_is_missed_once_its_time_is_over_outside_the_band() {
        let settle = Expectation::of_metric(Metric::SettleTime, None, Some(2.0));
        assert_eq!(after(&settle, Measured::Never, 1_900), Standing::Open);
        assert_eq!(after(&settle, Measured::Never, 2_001), Standing::Missed);
        assert_eq!(after(&settle, Measured::Value(1.5), 1_900), Standing::Within);
        let static_error = Expectation::of_metric(Metric::StaticError, None, Some(2.0));
        assert_eq!(after(&static_error, Measured::RunTooShort, 2_001), Standing::Open);
    }

    #[test]
    fn a_window_that_is_over_decides_any_quantity() {
        let quantity = Quantity::Statistic { signal: "torque_nm".to_owned(), statistic: Statistic::Mean };
        let window = Some(Window { from_s: 0.5, to_s: Some(1.0) });
        let mean = Expectation::new(Query { quantity, window }, "N m", Some(1.0), None);
        assert_eq!(after(&mean, Measured::RunTooShort, 999), Standing::Open);
        assert_eq!(after(&mean, Measured::Value(1.5), 1_000), Standing::Met);
        assert_eq!(after(&mean, Measured::Value(0.5), 1_000), Standing::Missed);
    }

    #[test]
    fn a_run_that_is_not_finite_misses_every_expectation() {
        let rms = Expectation::of_metric(Metric::RmsTorque, None, Some(5.0));
        assert_eq!(after(&rms, Measured::NotFinite, 1), Standing::Missed);
    }
}
