//! The metrics of two summaries side by side.

use lashloop_plant::metrics::Metric;
use serde::Serialize;

use super::tolerance::Tolerances;
use crate::summary::Summary;

/// A metric, or the quantity of an expectation, in both records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MetricDifference {
    /// Name of the metric; of an expectation its signal, statistic and window.
    pub name: String,
    /// Unit of the values.
    pub unit: String,
    /// The values.
    pub values: [Option<f64>; 2],
    /// Why a record has no value.
    pub reasons: [Option<String>; 2],
    /// The largest difference allowed, in the unit; `None` for equal bits.
    pub tolerance: Option<f64>,
    /// Whether the values are within the tolerance. A value that only one record has never is.
    pub within: bool,
}

impl MetricDifference {
    /// Second value minus the first, if both exist.
    #[must_use]
    pub fn difference(&self) -> Option<f64> {
        let [Some(a), Some(b)] = self.values else { return None };
        Some(b - a)
    }

    /// Whether both records have the same bits, or neither a value.
    #[must_use]
    pub fn has_equal_bits(&self) -> bool {
        let [a, b] = self.values.map(|it| it.map(f64::to_bits));
        a == b
    }
}

/// A value of one summary.
struct Quantity {
    name: String,
    unit: String,
    value: Option<f64>,
    reason: Option<String>,
}

/// Compares the metrics of two summaries, then the quantities of expectations that aren't metrics of the whole run.
pub(super) fn compare(summaries: [&Summary; 2], tolerances: &Tolerances) -> Vec<MetricDifference> {
    let [a, mut b] = summaries.map(quantities);
    let mut rows: Vec<_> = a
        .into_iter()
        .map(|quantity| {
            let twin = b.iter().position(|other| other.name == quantity.name).map(|at| b.remove(at));
            [Some(quantity), twin]
        })
        .collect();
    rows.extend(b.into_iter().map(|quantity| [None, Some(quantity)]));
    rows.into_iter().map(|pair| difference(pair, tolerances)).collect()
}

fn difference(pair: [Option<Quantity>; 2], tolerances: &Tolerances) -> MetricDifference {
    let either = || pair.iter().flatten();
    let name = either().next().map(|it| it.name.clone()).unwrap_or_default();
    let unit = either().map(|it| it.unit.clone()).find(|unit| !unit.is_empty()).unwrap_or_default();
    let values = [0, 1].map(|side| pair[side].as_ref().and_then(|it| it.value));
    let tolerance = tolerances.of(&name).map(|it| it.at(values[0].map_or(0.0, f64::abs)));
    let within = match (values, tolerance) {
        ([Some(a), Some(b)], Some(limit)) => (b - a).abs() <= limit,
        ([a, b], _) => a.map(f64::to_bits) == b.map(f64::to_bits),
    };
    let reasons = pair.map(|it| match it {
        None => Some("not in this record".to_owned()),
        Some(it) => it.reason,
    });
    MetricDifference { name, unit, values, reasons, tolerance, within }
}

fn quantities(summary: &Summary) -> Vec<Quantity> {
    let unit = |name: &str| Metric::named(name).map_or("", Metric::unit).to_owned();
    let metrics = summary.metrics.iter().map(|(name, value)| Quantity {
        name: name.clone(),
        unit: unit(name),
        value: *value,
        reason: summary.metrics_without_value.get(name).cloned(),
    });
    let mut quantities: Vec<_> = metrics.collect();
    for expectation in &summary.expectations {
        let name = expectation.name();
        if quantities.iter().all(|it| it.name != name) {
            let (unit, reason) = (expectation.unit.clone(), expectation.reason.clone());
            quantities.push(Quantity { name, unit, value: expectation.value.value(), reason });
        }
    }
    quantities
}

#[cfg(test)]
mod tests {
    use lashloop_bench::verdict::JudgedExpectation;
    use lashloop_plant::metrics::{Measured, Quantity, Statistic, Window};

    use super::*;
    use crate::summary::tests::summary as plain;

    fn summary(static_error_rad: Option<f64>, windowed: f64) -> Summary {
        let judged = |quantity, window, value: Option<f64>, unit: &str| JudgedExpectation {
            quantity,
            window,
            value: value.map_or(Measured::NotMeasured, Measured::Value),
            reason: None,
            unit: unit.to_owned(),
            min: None,
            max: None,
            ok: true,
        };
        let window = Some(Window { from_s: 1.0, to_s: Some(2.0) });
        let torque = Quantity::Statistic { signal: "torque_nm".to_owned(), statistic: Statistic::Max };
        Summary {
            metrics: [("static_error_rad", static_error_rad), ("hunting_rad", None)]
                .map(|(name, value)| (name.to_owned(), value))
                .into(),
            metrics_without_value: [("hunting_rad".to_owned(), "run too short".to_owned())].into(),
            expectations: vec![
                judged(Quantity::Metric(Metric::StaticError), None, static_error_rad, "rad"),
                judged(torque, window, Some(windowed), "N m"),
            ],
            ..plain()
        }
    }

    #[test]
    fn metrics_come_in_the_order_of_reports_and_windows_after_them() {
        let rows = compare([&summary(Some(0.1), 3.0), &summary(Some(0.15), 3.0)], &Tolerances::default());
        let names: Vec<_> = rows.iter().map(|row| (&*row.name, &*row.unit, row.within)).collect();
        assert_eq!(
            names,
            [
                ("static_error_rad", "rad", false),
                ("hunting_rad", "rad", true),
                ("max of torque_nm, 1 s to 2 s", "N m", true)
            ]
        );
        assert_eq!(rows[0].difference().map(|it| (it * 1e3).round()), Some(50.0));
        assert_eq!(rows[1].reasons, [Some("run too short".to_owned()), Some("run too short".to_owned())]);
    }

    #[test]
    fn a_metric_without_a_value_on_one_side_is_a_difference() {
        let [a, b] = [Some(0.1), None].map(|value| summary(value, 0.0));
        let tolerances = Tolerances(vec!["100%".parse().expect("a tolerance")]);
        assert!(!compare([&a, &b], &tolerances)[0].within);
        assert!(compare([&a, &summary(Some(0.2), 0.0)], &tolerances)[0].within);
        assert!(!compare([&a, &summary(Some(0.21), 0.0)], &tolerances)[0].within);
    }
}
