//! What the figures have in common: a curve for each law, and how a number is written.

use crate::plot::{Axis, Panel, Role, Series};
use lashloop_bench::record::trace::TraceRow;
use lashloop_plant::metrics::{Measured, Metric};

use super::laws::{Laws, Run};

/// The band of the settling time, as `settle_time_s` has it.
pub(super) const SETTLED_RAD: f64 = 0.05;

/// A panel with one quantity of each law over another.
pub(super) fn each(
    title: &str,
    (x_axis, x): (Axis, impl Fn(&TraceRow) -> f64),
    (y_axis, y): (Axis, impl Fn(&TraceRow) -> f64),
    laws: &Laws,
) -> Panel {
    laws.each().into_iter().fold(Panel::new(title, x_axis, y_axis), |panel, (name, role, run)| {
        let (x, y) = (run.rows.iter().map(&x).collect(), run.rows.iter().map(&y).collect());
        panel.series(Series::new(name, role, x, y))
    })
}

/// A panel with one quantity of each law over time.
pub(super) fn over_time(title: &str, axis: Axis, laws: &Laws, value: impl Fn(&TraceRow) -> f64) -> Panel {
    each(title, (Axis::new("time", "s"), |row: &TraceRow| row.time_s), (axis, value), laws)
}

/// What lies beyond a limit is not drawn, so that the rest can be read.
pub(super) fn within(limit: f64, value: impl Fn(&TraceRow) -> f64) -> impl Fn(&TraceRow) -> f64 {
    move |row| Some(value(row)).filter(|value| value.abs() <= limit).unwrap_or(f64::NAN)
}

/// What comes before a time is not drawn.
pub(super) fn from(time_s: f64, value: impl Fn(&TraceRow) -> f64) -> impl Fn(&TraceRow) -> f64 {
    move |row| if row.time_s >= time_s { value(row) } else { f64::NAN }
}

/// The runs with the rows alone that the drive's telemetry is of.
pub(super) fn told(laws: &Laws) -> Laws {
    let told = |run: &Run| Run {
        rows: run.rows.iter().filter(|row| row.estimate_time_s == row.time_s).copied().collect(),
        metrics: run.metrics.clone(),
    };
    Laws { before: told(&laws.before), after: told(&laws.after), beyond: told(&laws.beyond) }
}

pub(super) fn load_error_rad(row: &TraceRow) -> f64 {
    row.load_position_rad - row.reference_rad
}

/// Marks where each run settles for good; one that never does is marked at its end.
pub(super) fn mark_settling(panel: Panel, laws: &Laws, paper: [&str; 3]) -> Panel {
    laws.each().into_iter().zip(paper).fold(panel, |panel, ((_, role, run), paper)| {
        let settled_s = run.metrics.get(Metric::SettleTime).value();
        let label = settled_s.map_or("never settles".to_owned(), |settled_s| format!("{settled_s:.1} s"));
        let row = match settled_s {
            Some(settled_s) => run.rows.iter().find(|row| row.time_s >= settled_s),
            None => run.rows.last(),
        };
        mark(panel, role, row, &format!("{label}{paper}"))
    })
}

/// Marks the end of each run with its static error.
pub(super) fn mark_static_error(panel: Panel, laws: &Laws, paper: [&str; 3]) -> Panel {
    laws.each().into_iter().zip(paper).fold(panel, |panel, ((_, role, run), paper)| {
        let label = format!("{} rad{paper}", of(run, Metric::StaticError, 3));
        mark(panel, role, run.rows.last(), &label)
    })
}

fn mark(panel: Panel, role: Role, row: Option<&TraceRow>, label: &str) -> Panel {
    match row {
        Some(row) => panel.mark(label, role, row.time_s, row.load_position_rad),
        None => panel,
    }
}

/// A metric as it is set in a caption.
pub(super) fn of(run: &Run, metric: Metric, decimals: usize) -> String {
    written(run.metrics.get(metric), decimals).replace('-', "\u{2212}")
}

/// A metric as it is set in a table: the number, or why there is none.
pub(super) fn written(measured: Measured, decimals: usize) -> String {
    measured.value().map_or_else(|| measured.to_string(), |value| fixed(value, decimals))
}

/// Rounded first, so that a tiny negative number doesn't read "-0.000".
fn fixed(value: f64, decimals: usize) -> String {
    let scale = 10_f64.powi(decimals as i32);
    let rounded = (value * scale).round() / scale + 0.0;
    format!("{rounded:.decimals$}")
}
