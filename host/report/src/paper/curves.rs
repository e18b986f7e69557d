//! Curves and number formats that the figures share.

use crate::plot::{Axis, Panel, Role, Series};
use lashloop_bench::record::trace::TraceRow;
use lashloop_plant::metrics::{Measured, Metric};

use super::laws::{Laws, Run};

/// Settling band of `settle_time_s`, in rad.
pub(crate) const SETTLED_RAD: f64 = 0.05;

/// Name, role and run of a curve.
pub(crate) type Curve<'a> = (&'static str, Role, &'a Run);

/// A panel with one quantity of each law over another.
pub(crate) fn each<'a>(
    title: &str,
    (x_axis, x): (Axis, impl Fn(&TraceRow) -> f64),
    (y_axis, y): (Axis, impl Fn(&TraceRow) -> f64),
    laws: impl IntoIterator<Item = Curve<'a>>,
) -> Panel {
    laws.into_iter().fold(Panel::new(title, x_axis, y_axis), |panel, (name, role, run)| {
        let (x, y) = (run.rows.iter().map(&x).collect(), run.rows.iter().map(&y).collect());
        panel.series(Series::new(name, role, x, y))
    })
}

/// A panel with one quantity of each law over time.
pub(crate) fn over_time<'a>(
    title: &str,
    axis: Axis,
    laws: impl IntoIterator<Item = Curve<'a>>,
    value: impl Fn(&TraceRow) -> f64,
) -> Panel {
    each(title, (Axis::new("time", "s"), |row: &TraceRow| row.time_s), (axis, value), laws)
}

/// Hides values beyond a limit, so that the rest can be read.
pub(crate) fn within(limit: f64, value: impl Fn(&TraceRow) -> f64) -> impl Fn(&TraceRow) -> f64 {
    move |row| Some(value(row)).filter(|value| value.abs() <= limit).unwrap_or(f64::NAN)
}

/// Hides values before a time.
pub(crate) fn from(time_s: f64, value: impl Fn(&TraceRow) -> f64) -> impl Fn(&TraceRow) -> f64 {
    move |row| if row.time_s >= time_s { value(row) } else { f64::NAN }
}

/// The runs with only those rows for which the drive sent telemetry.
pub(crate) fn telemetered(laws: &Laws) -> Laws {
    let telemetered = |run: &Run| Run {
        rows: run.rows.iter().filter(|row| row.estimate_time_s == row.time_s).copied().collect(),
        metrics: run.metrics.clone(),
    };
    Laws {
        before: telemetered(&laws.before),
        after: telemetered(&laws.after),
        beyond: telemetered(&laws.beyond),
    }
}

pub(crate) fn load_error_rad(row: &TraceRow) -> f64 {
    row.load_position_rad - row.reference_rad
}

/// Marks the settling time of each run. A run that never settles is marked at its end.
pub(crate) fn mark_settling<'a, const N: usize>(
    panel: Panel,
    laws: impl IntoIterator<Item = Curve<'a>>,
    paper: [&str; N],
) -> Panel {
    laws.into_iter().zip(paper).fold(panel, |panel, ((_, role, run), paper)| {
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
pub(crate) fn mark_static_error<'a, const N: usize>(
    panel: Panel,
    laws: impl IntoIterator<Item = Curve<'a>>,
    paper: [&str; N],
) -> Panel {
    laws.into_iter().zip(paper).fold(panel, |panel, ((_, role, run), paper)| {
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

/// A metric, formatted for a caption.
pub(crate) fn of(run: &Run, metric: Metric, decimals: usize) -> String {
    written(run.metrics.get(metric), decimals).replace('-', "\u{2212}")
}

/// A metric of before, after and beyond, formatted for a caption.
pub(crate) fn three(laws: &Laws, metric: Metric, decimals: usize) -> String {
    laws.each().map(|(_, _, run)| of(run, metric, decimals)).join(", ")
}

/// A metric, formatted for a table: the number, or the reason for its absence.
pub(crate) fn written(measured: Measured, decimals: usize) -> String {
    measured.value().map_or_else(|| measured.to_string(), |value| fixed(value, decimals))
}

/// Rounds first, so that a tiny negative number does not become "-0.000".
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let scale = 10_f64.powi(decimals as i32);
    let rounded = (value * scale).round() / scale + 0.0;
    format!("{rounded:.decimals$}")
}
