//! Curves and number formats that the figures share.

use lashloop_plant::metrics::{Measured, Metric};
use lashloop_plot::{Axis, Panel, Role, Series};
use lashloop_record::trace::TELEMETRY_TIME;

use super::laws::{Laws, Run};

/// Name, role and run of a curve.
pub(crate) type Curve<'a> = (&'static str, Role, &'a Run);

/// The drive's signals that the figures show.
pub(crate) const DEAD_ZONE_ESTIMATE_RAD: &str = "drive.dead_zone_estimate_rad";
pub(crate) const DEAD_ZONE_DEVIATION_RAD: &str = "drive.dead_zone_deviation_rad";
pub(crate) const DISTURBING_TORQUE_ESTIMATE_NM: &str = "drive.disturbing_torque_estimate_nm";
pub(crate) const MOTOR_ERROR_RAD: &str = "drive.motor_error_rad";

/// A panel with one quantity of each law over another.
pub(crate) fn each<'a>(
    title: &str,
    (x_axis, x): (Axis, impl Fn(&Run) -> Vec<f64>),
    (y_axis, y): (Axis, impl Fn(&Run) -> Vec<f64>),
    laws: impl IntoIterator<Item = Curve<'a>>,
) -> Panel {
    laws.into_iter().fold(Panel::new(title, x_axis, y_axis), |panel, (name, role, run)| {
        panel.series(Series::new(name, role, x(run), y(run)))
    })
}

/// A panel with one quantity of each law over time.
pub(crate) fn over_time<'a>(
    title: &str,
    axis: Axis,
    laws: impl IntoIterator<Item = Curve<'a>>,
    quantity: impl Fn(&Run) -> Vec<f64>,
) -> Panel {
    each(title, (Axis::new("time", "s"), column("time_s")), (axis, quantity), laws)
}

/// A column of the trace as a quantity.
pub(crate) fn column(name: &'static str) -> impl Fn(&Run) -> Vec<f64> {
    move |run| run.column(name)
}

/// Hides values beyond a limit, so that the rest can be read.
pub(crate) fn within(limit: f64, quantity: impl Fn(&Run) -> Vec<f64>) -> impl Fn(&Run) -> Vec<f64> {
    move |run| hide(quantity(run), |_, value| value.abs() > limit)
}

/// Hides values before a time.
pub(crate) fn from(from_s: f64, quantity: impl Fn(&Run) -> Vec<f64>) -> impl Fn(&Run) -> Vec<f64> {
    move |run| {
        let time_s = run.column("time_s");
        hide(quantity(run), |row, _| time_s[row] < from_s)
    }
}

fn hide(mut values: Vec<f64>, is_hidden: impl Fn(usize, f64) -> bool) -> Vec<f64> {
    for (row, value) in values.iter_mut().enumerate() {
        if is_hidden(row, *value) {
            *value = f64::NAN;
        }
    }
    values
}

/// The runs with only those rows for which the drive sent telemetry.
pub(crate) fn telemetered(laws: &Laws) -> Laws {
    let telemetered = |run: &Run| {
        let (time_s, sent_s) = (run.column("time_s"), run.column(TELEMETRY_TIME));
        Run { trace: run.trace.select(|row| sent_s[row] == time_s[row]), metrics: run.metrics.clone() }
    };
    Laws {
        before: telemetered(&laws.before),
        after: telemetered(&laws.after),
        beyond: telemetered(&laws.beyond),
    }
}

pub(crate) fn load_error_rad(run: &Run) -> Vec<f64> {
    run.difference("load_position_rad", "reference_rad")
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
            Some(settled_s) => run.column("time_s").iter().position(|time_s| *time_s >= settled_s),
            None => run.trace.len().checked_sub(1),
        };
        mark(panel, role, run, "load_position_rad", row, &format!("{label}{paper}"))
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
        mark_end(panel, role, run, "load_position_rad", &label)
    })
}

/// Marks the end of a run in a quantity.
pub(crate) fn mark_end(panel: Panel, role: Role, run: &Run, name: &str, label: &str) -> Panel {
    mark(panel, role, run, name, run.trace.len().checked_sub(1), label)
}

fn mark(panel: Panel, role: Role, run: &Run, name: &str, row: Option<usize>, label: &str) -> Panel {
    match row {
        Some(row) => panel.mark(label, role, run.column("time_s")[row], run.column(name)[row]),
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
