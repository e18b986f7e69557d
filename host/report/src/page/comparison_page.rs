//! The page that compares several runs.

use maud::{Markup, html};

use super::data::{Chart, Data, Part, Series};
use super::input::Run;
use super::part::{metrics, plots, settings};
use super::run_charts::{error_rad, estimates, spelled};
use super::shell::{Link, document};
use super::why::{Tone, sentence, verdict};

const LINKS: [Link; 4] =
    [("runs", "Runs"), ("settings", "What differs"), ("plots", "Plots"), ("metrics", "Metrics")];

/// A quantity of a run: name of its column, and a value for each step.
type Named = (String, Vec<f64>);

/// Several records over the same axes, as a self-contained HTML document. The first is what the others are compared with.
#[must_use]
pub fn comparison(runs: &[Run]) -> String {
    let (data, ()) = Data::fitted(runs, |data| (charts(runs, data), ()));
    let title = format!("Comparison of {} runs", runs.len());
    let content = html! {
        section #runs {
            h1 { (title) }
            (table(runs))
        }
        (settings::section(runs))
        section #plots {
            h2 { "Plots" }
            (plots::controls())
            (plots::charts(&data, Part::Motion))
            (plots::note(&data))
        }
        (metrics::side_by_side(runs))
    };
    document(&title, &LINKS, Some(&data), &content)
}

fn table(runs: &[Run]) -> Markup {
    html! {
        div.scroll { table.runs {
            thead { tr { th scope="col" { "run" } th scope="col" { "verdict" } th scope="col" { "why" } } }
            tbody { @for (number, run) in runs.iter().enumerate() { tr {
                th scope="row" { span class={ "run-key c" (number % 8) } {} (run.name) }
                td { span class={ "grade " (Tone::of(run).class()) } { (verdict(run)) } }
                td.meaning { (sentence(run)) }
            } } }
        } }
    }
}

fn charts(runs: &[Run], mut data: Data) -> Data {
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
    push(&mut data, "Twist", "rad", &|run| column(run, "twist_rad"));
    let mut names: Vec<(String, String)> = Vec::new();
    for pair in runs.iter().flat_map(estimates) {
        if !names.contains(&pair) {
            names.push(pair);
        }
    }
    for (estimate, truth) in &names {
        let unit = runs.iter().find_map(|run| run.record.trace.columns.unit(estimate)).unwrap_or_default();
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
        let trip: Vec<_> = run.timing.iter().map(super::part::timing::round_trip_us).collect();
        trip.iter().any(|value| value.is_finite()).then(|| ("round_trip_us".to_owned(), trip))
    });
    trail(
        &mut data,
        runs,
        "Phase plane",
        ["error_rad", "load_velocity_rad_s"],
        [("position error", "rad"), ("load velocity", "rad/s")],
    );
    trail(
        &mut data,
        runs,
        "Hysteresis of gap and shaft",
        ["twist_rad", "transmitted_torque_nm"],
        [("twist", "rad"), ("transmitted torque", "N m")],
    );
    data
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
        series.push(of_run(number, run, id));
    }
    Chart::new(title, unit, series)
}

/// Eight colours, then the same dashed.
fn of_run(number: usize, run: &Run, id: super::data::ColumnId) -> Series {
    let series = Series::new(&run.name, number, id).style(format!("c{}", number % 8));
    if number / 8 % 2 == 1 { series.dashed() } else { series }
}

/// A chart of one column over another, in every run that has both.
fn trail(data: &mut Data, runs: &[Run], title: &str, names: [&str; 2], axes: [(&str, &str); 2]) {
    let mut series = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let values = |name: &str| match name {
            "error_rad" => error_rad(run),
            name => run.column(name).map(<[f64]>::to_vec),
        };
        let Some((x, y)) = values(names[0]).zip(values(names[1])) else { continue };
        let x = data.column(number, names[0], || x);
        let y = data.column(number, names[1], || y);
        series.push(of_run(number, run, y).over(x));
    }
    if !series.is_empty() {
        data.charts.push(Chart::new(title, "", series).axes(axes[0], axes[1]));
    }
}
