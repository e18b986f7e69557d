//! `[[expect]]`: bounds on a metric that a run must meet to pass.

use serde::Serialize;

use super::range::NumberRange;
use super::reader::Section;
use lashloop_plant::metrics::Metric;

/// Bounds on one metric, inclusive. At least one is given.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Expectation {
    /// The metric.
    pub metric: Metric,
    /// The metric's unit, which the scenario has to give.
    pub unit: &'static str,
    /// Smallest value that passes, -1e9 to 1e9.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Largest value that passes, -1e9 to 1e9.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Source of the bounds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

pub(super) fn read(expect: &mut Section<'_>) -> Expectation {
    let metric = expect.choice("metric", None, &Metric::ALL.map(|metric| (metric.name(), metric)));
    let unit = metric.map_or("", Metric::unit);
    check_unit(expect, metric);
    let bound = NumberRange::from(-1e9..=1e9);
    let min = expect.optional_number("min", unit, bound);
    let max = expect.optional_number("max", unit, bound);
    let note = expect.text("note", None).map(str::to_owned);
    match (min, max) {
        (None, None) => expect.reject_section("gives neither min nor max; it must give at least one"),
        (Some(min), Some(max)) if min > max && expect.is_option("max") => {
            expect.reject("max", format!("is less than min; it must be >= {min} {unit}"));
        }
        (Some(min), Some(max)) if min > max => {
            expect.reject("min", format!("is greater than max; it must be <= {max} {unit}"));
        }
        _ => {}
    }
    Expectation { metric: metric.unwrap_or(Metric::SettleTime), unit, min, max, note }
}

/// A bound in milliradians on a metric in radians would pass everything, so the unit is required and checked.
fn check_unit(expect: &mut Section<'_>, metric: Option<Metric>) {
    let Some(metric) = metric else {
        expect.text("unit", None);
        return;
    };
    let allowed = format!("\"{}\"", metric.unit());
    if let Some(found) = expect.text("unit", Some(&allowed))
        && found != metric.unit()
    {
        expect.reject("unit", format!("is not the unit of {}; it must be {allowed}", metric.name()));
    }
}
