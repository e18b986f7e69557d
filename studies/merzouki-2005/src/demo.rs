//! The demo: the paper's two plants, each under its two laws and under one beyond it, as a table and a figure.

use lashloop_bench::scenario::{Scenario, ScenarioErrors};
use lashloop_bench::verdict::Verdict;
use lashloop_plant::metrics::{Measured, Metric};
use lashloop_plot::Figure;

use crate::figures::demo::{DemoRuns, before_after};
use crate::figures::{Laws, Run};
use crate::plan::{PLANS, scenario};

/// The paper's result for each scenario, and the metric to compare it with. The paper has no law beyond it.
const PAPER: [(&str, Metric, &str); 6] = [
    ("smooth plant, before: into 0.05 rad", Metric::SettleTime, "about 13 s"),
    ("smooth plant, after: into 0.05 rad", Metric::SettleTime, "about 5.2 s"),
    ("smooth plant, beyond: into 0.05 rad", Metric::SettleTime, "-"),
    ("with friction, before: static error", Metric::StaticError, "0.32 rad"),
    ("with friction, after: static error", Metric::StaticError, "eliminated"),
    ("with friction, beyond: static error", Metric::StaticError, "-"),
];

/// File of the figure in its folder.
pub const FIGURE_FILE: &str = "demo.svg";

/// The scenarios, in the order of the rows.
///
/// # Errors
/// None, unless a scenario is wrong.
pub fn scenarios() -> Result<Vec<Scenario>, ScenarioErrors> {
    let [smooth, friction, ..] = PLANS;
    [smooth, friction].as_flattened().iter().map(|(source, law)| scenario(*source, *law)).collect()
}

/// The head of the table.
#[must_use]
pub fn head() -> String {
    format!("{:<38} {:>12} {:>12}  verdict", "", "paper", "here")
}

/// The row of a scenario, by its number.
///
/// # Panics
/// There is no such scenario.
#[must_use]
pub fn row(number: usize, run: &Run, verdict: Verdict) -> String {
    let (what, metric, paper) = PAPER[number];
    let here = here(run.metrics.get(metric), metric);
    format!("{what:<38} {paper:>12} {here:>12}  {verdict}")
}

fn here(measured: Measured, metric: Metric) -> String {
    match measured.value() {
        Some(value) if metric == Metric::SettleTime => format!("{value:.2} s"),
        Some(value) => format!("{value:.4} rad"),
        None => measured.to_string(),
    }
}

/// The figure of the runs of all scenarios.
///
/// # Panics
/// A run is missing.
#[must_use]
pub fn figure(runs: Vec<Run>, scenarios: &[Scenario]) -> Figure {
    let mut runs = runs.into_iter();
    let mut laws = || {
        let mut next = || runs.next().expect("one run for each scenario");
        Laws { before: next(), after: next(), beyond: next() }
    };
    let (smooth, friction) = (laws(), laws());
    let dead_zone_rad = scenarios.last().and_then(|it| it.plant.number("dead_zone_rad"));
    before_after(&DemoRuns { smooth, friction, dead_zone_rad: dead_zone_rad.unwrap_or(f64::NAN) })
}
