//! The metrics of two summaries side by side.

use lashloop_plant::metrics::Metric;
use serde::Serialize;
use serde_json::Value;

use super::tolerance::Tolerances;

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
    /// Second value less the first, if both exist.
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

/// Compares the metrics of two summaries, then the quantities of expectations that are no metric of the whole run.
pub(super) fn compare(summaries: [&Value; 2], tolerances: &Tolerances) -> Vec<MetricDifference> {
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

fn quantities(summary: &Value) -> Vec<Quantity> {
    let metrics = summary["metrics"].as_object();
    let reason = |name: &str| summary["metrics_without_value"][name].as_str().map(str::to_owned);
    let unit =
        |name: &str| Metric::ALL.iter().find(|it| it.name() == name).map_or("", |it| it.unit()).to_owned();
    // In the order of reports: the file's own order is lost.
    let place = |name: &str| Metric::ALL.iter().position(|it| it.name() == name).unwrap_or(usize::MAX);
    let mut quantities: Vec<_> = metrics
        .into_iter()
        .flatten()
        .map(|(name, value)| Quantity {
            name: name.clone(),
            unit: unit(name),
            value: value.as_f64(),
            reason: reason(name),
        })
        .collect();
    quantities.sort_by_key(|it| place(&it.name));
    for expectation in summary["expectations"].as_array().into_iter().flatten() {
        let name = expectation_name(expectation);
        if quantities.iter().all(|it| it.name != name) {
            let text = |key: &str| expectation[key].as_str().map(str::to_owned);
            let (unit, value) = (text("unit").unwrap_or_default(), expectation["value"].as_f64());
            quantities.push(Quantity { name, unit, value, reason: text("reason") });
        }
    }
    quantities
}

/// The metric, or signal and statistic, with the window if it has one.
fn expectation_name(expectation: &Value) -> String {
    let text = |key: &str| expectation[key].as_str().unwrap_or_default();
    let name = match text("metric") {
        "" => format!("{} of {}", text("statistic"), text("signal")),
        metric => metric.to_owned(),
    };
    match ["from_s", "to_s"].map(|key| expectation[key].as_f64()) {
        [None, _] => name,
        [Some(from_s), None] => format!("{name}, {from_s} s to the end"),
        [Some(from_s), Some(to_s)] => format!("{name}, {from_s} s to {to_s} s"),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn summary(static_error: Value, hunting: Value, windowed: f64) -> Value {
        json!({
            "metrics": {"hunting_rad": hunting, "static_error_rad": static_error},
            "metrics_without_value": {"hunting_rad": "run too short"},
            "expectations": [
                {"metric": "static_error_rad", "value": static_error, "unit": "rad"},
                {"signal": "torque_nm", "statistic": "max", "from_s": 1.0, "to_s": 2.0, "value": windowed, "unit": "N m"}
            ]
        })
    }

    #[test]
    fn metrics_come_in_the_order_of_reports_and_windows_after_them() {
        let a = summary(json!(0.1), json!(null), 3.0);
        let rows = compare([&a, &summary(json!(0.15), json!(null), 3.0)], &Tolerances::default());
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
        let [a, b] = [json!(0.1), json!(null)].map(|value| summary(value, json!(null), 0.0));
        let tolerances = Tolerances(vec!["100%".parse().expect("a tolerance")]);
        assert!(!compare([&a, &b], &tolerances)[0].within);
        assert!(compare([&a, &summary(json!(0.2), json!(null), 0.0)], &tolerances)[0].within);
        assert!(!compare([&a, &summary(json!(0.21), json!(null), 0.0)], &tolerances)[0].within);
    }
}
