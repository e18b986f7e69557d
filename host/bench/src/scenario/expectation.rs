//! `[[expect]]`: bounds that a run must meet to pass, on a metric or on a statistic of a signal.

mod measurable;

pub(super) use measurable::{PlannedRun, unmeasurable};

use serde::Serialize;

use super::declare::{Field as _, Named, any_text, by, choice, flat, number, skipped, text};
use super::origin::Origin;
use super::range::positive;
use super::reader::Section;
use super::spelling::either;
use crate::settings;
use lashloop_plant::metrics::{FIXED_SIGNALS, Metric, Quantity, Query, Statistic, Window};

settings! {
    /// Bounds on one quantity, inclusive. At least one is given.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct Expectation {
        /// The metric, or the signal and its statistic.
        #[serde(flatten)]
        pub quantity: Quantity = flat(QuantityKeys::checked),
        /// Unit of the metric or of the signal; it is checked.
        pub unit: String = by(|expect| text(allowed_unit(expect))).map(check_unit),
        /// Smallest value that passes.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub min: Option<f64> = by(|expect| number(-1e9..=1e9).in_unit(unit_of_bounds(expect)).optional()),
        /// Largest value that passes.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub max: Option<f64> = by(|expect| number(-1e9..=1e9).in_unit(unit_of_bounds(expect)).optional()),
        /// The part of the run that is judged; `None` for all of it.
        #[serde(flatten)]
        pub window: Option<Window> = flat(WindowKeys::checked),
        /// Source of the bounds.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub note: Option<String> = any_text(),
        /// Where the keys are written.
        #[serde(skip)]
        places: Places = skipped(Places::of),
    }
}

settings! {
    /// The keys of what is judged.
    struct QuantityKeys {
        /// Metric to judge; [metrics.md](metrics.md) defines each.
        metric: Option<Metric> = choice().optional(),
        /// Signal to judge instead of a metric: a fixed column of the trace, a signal of the plant, or `drive.NAME`.
        signal: Option<String> = any_text(),
        /// Statistic of the signal's values v in the window.
        statistic: Option<Statistic> = choice().optional(),
    }
}

settings! {
    /// The keys of the part that is judged. Ends within the run are checked once all of the scenario is known.
    struct WindowKeys {
        /// Start of the window that is judged, in time of the run; the start of the run if absent.
        from_s: Option<f64> = number(0.0..=1e5).optional(),
        /// End of the window that is judged; the end of the run if absent.
        to_s: Option<f64> = number(positive(1e5)).optional(),
    }
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

/// The metric, or the signal and its statistic; `None` if they are faulty.
fn quantity(expect: &Section<'_>) -> Option<Quantity> {
    match (expect.has("metric"), expect.has("signal"), expect.has("statistic")) {
        (true, false, false) => Metric::named(expect.text("metric")?).map(Quantity::Metric),
        (false, true, true) => {
            let statistic = Statistic::named(expect.text("statistic")?)?;
            Some(Quantity::Statistic { signal: expect.text("signal")?.to_owned(), statistic })
        }
        _ => None,
    }
}

/// The unit that the expectation has to give and whose it is, if it is known; a plant's or a drive's signal is checked before
/// the run. A bound in milliradians on a metric in radians would pass everything, so the unit is required and checked.
fn known_unit(expect: &Section<'_>) -> Option<(&'static str, &'static str)> {
    match quantity(expect)? {
        Quantity::Metric(metric) => Some((metric.name(), metric.unit())),
        Quantity::Statistic { signal, .. } => {
            FIXED_SIGNALS.iter().find(|fixed| fixed.name == *signal).map(|it| (&*it.name, &*it.unit))
        }
    }
}

fn allowed_unit(expect: &Section<'_>) -> String {
    match (known_unit(expect), quantity(expect)) {
        (Some((_, unit)), _) => format!("\"{unit}\""),
        (None, Some(_)) => "the unit of the signal, such as \"rad\"".to_owned(),
        (None, None) => "a unit in quotes".to_owned(),
    }
}

/// The unit of a metric's bounds. A signal's isn't known to the messages about its bounds.
fn unit_of_bounds(expect: &Section<'_>) -> &'static str {
    match quantity(expect) {
        Some(Quantity::Metric(metric)) => metric.unit(),
        _ => "",
    }
}

fn check_unit(unit: String, expect: &mut Section<'_>) -> String {
    let Some((name, known)) = known_unit(expect) else { return unit };
    if expect.text("unit").is_some_and(|unit| unit != known) {
        expect.reject("unit", wrong_unit(name, known));
    }
    known.to_owned()
}

impl Expectation {
    pub(super) fn checked(self, expect: &mut Section<'_>) -> Self {
        let unit = unit_of_bounds(expect);
        match (self.min, self.max) {
            (None, None) => expect.reject_section("gives neither min nor max; it must give at least one"),
            (Some(min), Some(max)) if min > max && expect.is_option("max") => {
                expect.reject("max", format!("is less than min; it must be >= {min} {unit}"));
            }
            (Some(min), Some(max)) if min > max => {
                expect.reject("min", format!("is greater than max; it must be <= {max} {unit}"));
            }
            _ => {}
        }
        self
    }
}

impl QuantityKeys {
    fn checked(self, expect: &mut Section<'_>) -> Quantity {
        match (expect.has("metric"), expect.has("signal"), expect.has("statistic")) {
            (true, false, false) | (false, true, true) => {}
            (false, false, false) => expect.reject_section(
                "names nothing to judge; it must give a metric, or a signal and its statistic",
            ),
            (false, true, false) => {
                let names = either(Statistic::ALL.map(Statistic::name));
                expect.reject("signal", format!("has no statistic; add statistic = {names}"));
            }
            (false, false, true) => {
                expect.reject("statistic", "has no signal; add signal = \"NAME\" or \"drive.NAME\"");
            }
            (true, signal, _) => {
                let key = if signal { "signal" } else { "statistic" };
                let reason = "is given with a metric; give either a metric, or a signal and its statistic";
                expect.reject(key, reason);
            }
        }
        match (self.metric, self.signal, self.statistic) {
            (Some(metric), None, None) => Quantity::Metric(metric),
            (None, Some(signal), Some(statistic)) => Quantity::Statistic { signal, statistic },
            // The stand-in of a faulty one; the scenario is rejected.
            _ => Quantity::Metric(Metric::SettleTime),
        }
    }
}

impl WindowKeys {
    fn checked(self, expect: &mut Section<'_>) -> Option<Window> {
        let Self { from_s, to_s } = self;
        if let (Some(from), Some(to)) = (from_s, to_s)
            && from >= to
        {
            let key = if expect.is_option("from_s") { "from_s" } else { "to_s" };
            let (side, bound) = if key == "to_s" { (">", from) } else { ("<", to) };
            expect.reject(key, format!("leaves no window from from_s to to_s; it must be {side} {bound} s"));
        }
        (from_s.is_some() || to_s.is_some()).then(|| Window { from_s: from_s.unwrap_or(0.0), to_s })
    }
}

impl Places {
    fn of(expect: &Section<'_>) -> Self {
        let origin = |key| expect.node(key).map(|node| node.origin.clone());
        Self {
            quantity: origin("metric").or_else(|| origin("signal")),
            unit: origin("unit"),
            from_s: origin("from_s"),
            to_s: origin("to_s"),
        }
    }
}

/// The end of the sentence about a unit that isn't the quantity's.
fn wrong_unit(name: &str, unit: &str) -> String {
    format!("is not the unit of {name}; it must be \"{unit}\"")
}

/// An error of the value `found` of a key of expectation number `index`.
fn error(index: usize, key: &str, origin: &Origin, found: String, reason: String) -> super::ScenarioError {
    super::ScenarioError::rejected(origin, format!("expect.{index}.{key}"), found, reason)
}
