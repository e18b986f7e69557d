//! The page that compares several runs.

use lashloop_bench::timing::ClockName;
use lashloop_record::diff::{Comparison, DiffOptions, Setting};
use maud::{Markup, html};

use super::chosen_panels::Panels;
use super::data::{Chart, Data, Part, Series, coloured};
use super::input::Run;
use super::part::{differences, metrics, plots, settings};
use super::run_charts::{
    HYSTERESIS, PHASE_PLANE, edges_of_gap, enlarged, error_rad, estimates, is_own, spelled, trail,
};
use super::shell::{Link, document};
use super::why::{Tone, sentence, verdict};
use crate::steps::round_trip_us;

const LINKS: [Link; 5] = [
    ("runs", "Runs"),
    ("result", "Result"),
    ("settings", "Set differently"),
    ("plots", "Plots"),
    ("metrics", "Metrics"),
];

/// Digits of a digest of all torques that distinguish runs.
const DIGITS_OF_DIGEST: usize = 12;

/// A quantity of a run: name of its column, and a value for each step.
type Named = (String, Vec<f64>);

/// Several records over the same axes, as a self-contained HTML document. The first is what the others are compared with;
/// `settings` are those of the same records. The user's panels are in front.
#[must_use]
pub fn comparison(runs: &[Run], settings: &[Setting], panels: &Panels) -> String {
    page(runs, settings, None, panels)
}

/// Two records over the same axes with the result of their comparison, as a self-contained HTML document.
#[must_use]
pub fn diff(runs: &[Run; 2], settings: &[Setting], comparison: &Comparison, options: &DiffOptions) -> String {
    page(runs, settings, Some(&differences::section(comparison, options)), &Panels::default())
}

fn page(runs: &[Run], settings: &[Setting], result: Option<&Markup>, panels: &Panels) -> String {
    let (data, ()) = Data::fitted(runs, |data| (charts(runs, data, panels), ()));
    let title = format!("Comparison of {} runs", runs.len());
    let content = html! {
        section #runs {
            h1 { (title) }
            (table(runs))
        }
        @if let Some(result) = result { (result) }
        (settings::section(runs, settings))
        section #plots {
            h2 { "Plots" }
            (plots::controls())
            (plots::charts(&data, Part::Motion))
            (plots::note(&data))
        }
        (metrics::side_by_side(runs))
    };
    let has_section = |(id, _): &&Link| *id != "result" || result.is_some();
    let links: Vec<_> = LINKS.iter().filter(has_section).copied().collect();
    document(&title, &links, Some(&data), &content)
}

fn table(runs: &[Run]) -> Markup {
    html! {
        div.scroll { table.runs {
            thead { tr { th scope="col" { "run" } th scope="col" { "verdict" } th scope="col" { "why" } th scope="col" { "started" } th scope="col" { "torques" } } }
            tbody { @for (number, run) in runs.iter().enumerate() { tr {
                th scope="row" { span class={ "run-key c" (number % 8) } {} (run.name) }
                td { span class={ "grade " (Tone::of(run).class()) } { (verdict(run)) } }
                td.meaning { (sentence(run)) }
                td { (run.record.manifest.started.replace('T', " ").replace('Z', " UTC")) }
                td { @if let Some(digest) = run.record.summary.as_ref().map(|it| &it.torque_sha256) {
                    code.hash title=(digest) { (digest.chars().take(DIGITS_OF_DIGEST).collect::<String>()) }
                } }
            } } }
        } }
    }
}

/// The twists of all runs, and the same with the gap as high as the chart. Gaps that are equal have one pair of edges.
fn twist(data: &mut Data, runs: &[Run]) {
    let mut chart = of_all(data, runs, "Twist", "rad", |run| column(run, "twist_rad"));
    let mut drawn: Vec<&[f64]> = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let Some(half_gap_rad) = run.column("dead_zone_rad").filter(|it| !drawn.contains(it)) else {
            continue;
        };
        drawn.push(half_gap_rad);
        chart.series.extend(edges_of_gap(data, number, half_gap_rad));
    }
    let enlarged = enlarged(runs, &chart);
    if !chart.series.is_empty() {
        data.charts.push(chart);
    }
    data.charts.extend(enlarged);
}

fn charts(runs: &[Run], mut data: Data, panels: &Panels) -> Data {
    panels.draw(&mut data, runs);
    let mut position =
        of_all(&mut data, runs, "Load position", "rad", |run| column(run, "load_position_rad"));
    let mut drawn: Vec<&[f64]> = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let Some(reference_rad) = run.column("reference_rad").filter(|it| !drawn.contains(it)) else {
            continue;
        };
        drawn.push(reference_rad);
        let id = data.column(number, "reference_rad", || reference_rad.to_vec());
        position.series.push(Series::new("reference", number, id).style("reference").dashed());
    }
    data.charts.push(position);
    let push = |data: &mut Data, title: &str, unit: &str, quantity: &dyn Fn(&Run) -> Option<Named>| {
        let chart = of_all(data, runs, title, unit, quantity);
        if !chart.series.is_empty() {
            data.charts.push(chart);
        }
    };
    push(&mut data, "Position error", "rad", &|run| Some(("error_rad".to_owned(), error_rad(run)?)));
    push(&mut data, "Torque", "N m", &|run| column(run, "torque_nm"));
    twist(&mut data, runs);
    let mut names: Vec<(String, String)> = Vec::new();
    for pair in runs.iter().flat_map(estimates) {
        if !names.contains(&pair) {
            names.push(pair);
        }
    }
    for (name, unit) in own(runs, &names) {
        push(&mut data, &name, &unit, &|run| column(run, &name));
    }
    for (estimate, truth) in &names {
        let unit = runs.iter().find_map(|run| run.record.trace.unit(estimate)).unwrap_or_default();
        let title = format!("Estimate: {}", spelled(truth, unit));
        let mut chart = of_all(&mut data, runs, &title, unit, |run| column(run, estimate));
        // One truth for all, such as a gap that no run has changed.
        let truths: Vec<_> = runs.iter().map(|run| run.column(truth)).collect();
        if let Some(Some(values)) = truths.first().filter(|first| truths.iter().all(|it| it == *first)) {
            let id = data.column(0, truth, || values.to_vec());
            chart.series.push(Series::new("truth", 0, id).style("reference").dashed());
        }
        data.charts.push(chart);
    }
    push(&mut data, "Round trip", "us", &|run| {
        // In lockstep the timing changes no value.
        if run.record.manifest.clock == ClockName::Lockstep {
            return None;
        }
        let trip: Vec<_> = run.timing.iter().map(round_trip_us).collect();
        trip.iter().any(|value| value.is_finite()).then(|| ("round_trip_us".to_owned(), trip))
    });
    for over in [PHASE_PLANE, HYSTERESIS] {
        trail(&mut data, runs, over, None);
    }
    data
}

/// The drives' own signals, with their units: those that no other chart has, and that change in a run.
fn own(runs: &[Run], estimates: &[(String, String)]) -> Vec<(String, String)> {
    let mut own: Vec<(String, String)> = Vec::new();
    for run in runs {
        for signal in run.record.trace.signals() {
            let name = &*signal.name;
            let is_own = is_own(name) && estimates.iter().all(|(estimate, _)| estimate != name);
            let changes = || run.column(name).is_some_and(|it| it.iter().any(|value| *value != it[0]));
            if is_own && own.iter().all(|(other, _)| other != name) && changes() {
                own.push((name.to_owned(), signal.unit.to_string()));
            }
        }
    }
    own
}

fn column(run: &Run, name: &str) -> Option<Named> {
    Some((name.to_owned(), run.column(name)?.to_vec()))
}

/// A chart with a curve of every run that has the quantity, given with the name of its column.
fn of_all(
    data: &mut Data,
    runs: &[Run],
    title: &str,
    unit: &str,
    quantity: impl Fn(&Run) -> Option<Named>,
) -> Chart {
    let mut series = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let Some((name, mut values)) = quantity(run) else { continue };
        values.resize(run.times_s().len(), f64::NAN);
        let id = data.column(number, &name, || values);
        series.push(coloured(number, Series::new(&run.name, number, id)));
    }
    Chart::new(title, unit, series)
}
