//! `[[expect]]`: bounds that a run must meet to pass, on a metric or on a statistic of a signal.

mod measurable;

pub(super) use measurable::{PlannedRun, unmeasurable};

use serde::Serialize;

use super::key::Choice;
use super::key_error::KeyError;
use super::origin::Origin;
use super::range::{NumberRange, positive};
use super::reader::Section;
use super::spelling::either;
use lashloop_plant::metrics::{FIXED_SIGNALS, Metric, Quantity, Query, Statistic, Window};

/// Bounds on one quantity, inclusive. At least one is given.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Expectation {
    /// The metric, or the signal and its statistic.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// The quantity's unit, which the scenario has to give.
    pub unit: String,
    /// Smallest value that passes, -1e9 to 1e9.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Largest value that passes, -1e9 to 1e9.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// The part of the run that is judged; `None` for all of it.
    #[serde(flatten)]
    pub window: Option<Window>,
    /// Source of the bounds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    #[serde(skip)]
    places: Places,
}

/// Where the keys of an expectation are written; `None` for an expectation that no file has.
#[derive(Debug, Clone, Default)]
struct Places {
    quantity: Option<Origin>,
    unit: Option<Origin>,
    from_s: Option<Origin>,
    to_s: Option<Origin>,
}

/// Two expectations are equal if their values are; their places in the file don't count.
impl PartialEq for Places {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Expectation {
    /// Bounds on a quantity over the whole run or a window of it. `unit` is that of the quantity.
    #[must_use]
    pub fn new(query: Query, unit: &str, min: Option<f64>, max: Option<f64>) -> Self {
        let Query { quantity, window } = query;
        Self { quantity, unit: unit.to_owned(), min, max, window, note: None, places: Places::default() }
    }

    /// Bounds on a metric over the whole run.
    #[must_use]
    pub fn of_metric(metric: Metric, min: Option<f64>, max: Option<f64>) -> Self {
        Self::new(metric.into(), metric.unit(), min, max)
    }

    /// What the run has to measure.
    #[must_use]
    pub fn query(&self) -> Query {
        Query { quantity: self.quantity.clone(), window: self.window }
    }
}

pub(super) fn read(expect: &mut Section<'_>) -> Expectation {
    let quantity = read_quantity(expect);
    let unit = read_unit(expect, quantity.as_ref());
    // A signal's unit isn't known to the messages about its bounds.
    let unit_of_bounds = match &quantity {
        Some(Quantity::Metric(metric)) => metric.unit(),
        _ => "",
    };
    let bound = NumberRange::from(-1e9..=1e9);
    let min = expect.doc("Smallest value that passes.").optional_number("min", unit_of_bounds, bound);
    let max = expect.doc("Largest value that passes.").optional_number("max", unit_of_bounds, bound);
    match (min, max) {
        (None, None) => expect.reject_section("gives neither min nor max; it must give at least one"),
        (Some(min), Some(max)) if min > max && expect.is_option("max") => {
            expect.reject("max", format!("is less than min; it must be >= {min} {unit_of_bounds}"));
        }
        (Some(min), Some(max)) if min > max => {
            expect.reject("min", format!("is greater than max; it must be <= {max} {unit_of_bounds}"));
        }
        _ => {}
    }
    let window = read_window(expect);
    let note = expect.doc("Source of the bounds.").text("note", None).map(str::to_owned);
    let origin = |key| expect.node(key).map(|node| node.origin.clone());
    let places = Places {
        quantity: origin("metric").or_else(|| origin("signal")),
        unit: origin("unit"),
        from_s: origin("from_s"),
        to_s: origin("to_s"),
    };
    let quantity = quantity.unwrap_or(Quantity::Metric(Metric::SettleTime));
    Expectation { quantity, unit, min, max, window, note, places }
}

/// The metric, or the signal and its statistic; `None` if they are faulty.
fn read_quantity(expect: &mut Section<'_>) -> Option<Quantity> {
    let metrics = Metric::ALL.map(|metric| (metric.name(), Some(metric)));
    let metric = expect
        .doc("Metric to judge; [metrics.md](metrics.md) defines each.")
        .choice("metric", Some(None), &metrics)
        .flatten();
    let signal = expect
        .doc("Signal to judge instead of a metric: a fixed column of the trace, a signal of the plant, or `drive.NAME`.")
        .text("signal", None);
    let statistics = Statistic::ALL.map(|statistic| (statistic.name(), Some(statistic)));
    let docs = Statistic::ALL.map(|it| Choice { name: it.name(), doc: it.meaning() });
    let statistic = expect
        .doc("Statistic of the signal's values v in the window.")
        .choice_docs(docs.to_vec())
        .choice("statistic", Some(None), &statistics)
        .flatten();
    let is_given = |key| expect.node(key).is_some();
    match [is_given("metric"), is_given("signal"), is_given("statistic")] {
        [true, false, false] => return metric.map(Quantity::Metric),
        [false, true, true] => {
            return Some(Quantity::Statistic { signal: signal?.to_owned(), statistic: statistic? });
        }
        [false, false, false] => {
            expect.reject_section(
                "names nothing to judge; it must give a metric, or a signal and its statistic",
            );
        }
        [false, true, false] => {
            let names = either(Statistic::ALL.map(Statistic::name));
            expect.reject("signal", format!("has no statistic; add statistic = {names}"));
        }
        [false, false, true] => {
            expect.reject("statistic", "has no signal; add signal = \"NAME\" or \"drive.NAME\"".to_owned());
        }
        [true, signal, _] => {
            let key = if signal { "signal" } else { "statistic" };
            expect.reject(
                key,
                "is given with a metric; give either a metric, or a signal and its statistic".to_owned(),
            );
        }
    }
    None
}

/// A bound in milliradians on a metric in radians would pass everything, so the unit is required and checked: here, if it is
/// known; a plant's or a drive's signal is checked before the run.
fn read_unit(expect: &mut Section<'_>, quantity: Option<&Quantity>) -> String {
    expect.doc("Unit of the metric or of the signal; it is checked.");
    let (name, unit) = match quantity {
        Some(Quantity::Metric(metric)) => (metric.name(), metric.unit()),
        Some(Quantity::Statistic { signal, .. }) => {
            match FIXED_SIGNALS.iter().find(|fixed| fixed.name == signal.as_str()) {
                Some(fixed) => (&*fixed.name, &*fixed.unit),
                None => {
                    let unit = expect.text("unit", Some("the unit of the signal, such as \"rad\""));
                    return unit.unwrap_or_default().to_owned();
                }
            }
        }
        None => return expect.text("unit", Some("a unit in quotes")).unwrap_or_default().to_owned(),
    };
    let allowed = format!("\"{unit}\"");
    if let Some(found) = expect.text("unit", Some(&allowed))
        && found != unit
    {
        expect.reject("unit", wrong_unit(name, unit));
    }
    unit.to_owned()
}

/// The end of the sentence about a unit that isn't the quantity's.
fn wrong_unit(name: &str, unit: &str) -> String {
    format!("is not the unit of {name}; it must be \"{unit}\"")
}

/// The part of the run that is judged. Ends within the run are checked once all of the scenario is known.
fn read_window(expect: &mut Section<'_>) -> Option<Window> {
    let from_s = expect
        .doc("Start of the window that is judged, in time of the run; the start of the run if absent.")
        .optional_number("from_s", "s", 0.0..=1e5);
    let to_s = expect.doc("End of the window that is judged; the end of the run if absent.").optional_number(
        "to_s",
        "s",
        positive(1e5),
    );
    if let (Some(from), Some(to)) = (from_s, to_s)
        && from >= to
    {
        let key = if expect.is_option("from_s") { "from_s" } else { "to_s" };
        let (side, bound) = if key == "to_s" { (">", from) } else { ("<", to) };
        expect.reject(key, format!("leaves no window from from_s to to_s; it must be {side} {bound} s"));
    }
    (from_s.is_some() || to_s.is_some()).then(|| Window { from_s: from_s.unwrap_or(0.0), to_s })
}

/// An error of the value `found` of a key of expectation number `index`.
fn error(index: usize, key: &str, origin: &Origin, found: String, reason: String) -> super::ScenarioError {
    super::ScenarioError::Key {
        origin: origin.clone(),
        key: format!("expect.{index}.{key}"),
        error: Box::new(KeyError::Rejected { found, reason }),
    }
}
