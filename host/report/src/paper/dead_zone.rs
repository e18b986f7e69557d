//! Figures 5 and 14: the torque through the dead zone, and what compensation makes of it.

use crate::plot::{Axis, Figure, Panel, Role, Series};
use lashloop_bench::record::trace::TraceRow;
use lashloop_plant::metrics::Metric;

use super::curves::{each, over_time, telemetered, three};
use super::laws::{Laws, Runs};

pub(super) fn transmitted_torque(runs: &Runs) -> Figure {
    let twist_at = |row: &&TraceRow| row.transmitted_torque_nm == 0.0 && row.twist_rad >= 0.0;
    let edge_rad = runs.hard_gap.iter().filter(twist_at).map(|row| row.twist_rad).fold(0.0, f64::max);
    let caption = format!(
        "The paper: C = C0 + w is smooth and zero inside the gap.\n\
         Here: a) smooth, with no slope at z = 0, but nonzero elsewhere; far outside, the line is offset by 4 j0, so this gap is \
         four times as wide as its parameter j0 says, and the load creeps in it. b) the gap of the backlash shaft, in contact at \
         rest: nothing within {edge_rad:.2} rad, and the spring's full slope beyond."
    );
    Figure::new("Figure 5: transmitted torque C and its parts", caption, 2)
        .panel(parts("Smooth plant, as the paper has it", &runs.smooth_gap))
        .panel(parts("Backlash shaft, a hard gap", &runs.hard_gap))
}

/// C0, w and C against z, from the plant's own functions.
fn parts(title: &str, twisted: &[TraceRow]) -> Panel {
    let curve = |label, role, value: fn(&TraceRow) -> f64| {
        let twist_rad = twisted.iter().map(|row| row.twist_rad).collect();
        Series::new(label, role, twist_rad, twisted.iter().map(value).collect())
    };
    Panel::new(title, Axis::new("twist z", "rad"), Axis::new("torque", "N m"))
        .series(curve("C0 = K z", Role::Reference, |row| {
            row.transmitted_torque_nm - row.disturbing_torque_nm
        }))
        .series(curve("w", Role::Before, |row| row.disturbing_torque_nm))
        .series(curve("C = C0 + w", Role::After, |row| row.transmitted_torque_nm))
}

pub(super) fn made_linear(runs: &Runs) -> Figure {
    let rms = |laws| three(laws, Metric::DisturbingTorqueRmsError, 2);
    let caption = format!(
        "The paper: compensation makes the disturbing torque linear; with a right estimate C \u{2212} w_hat is the straight line \
         C0 = K z.\n\
         Here: it does not come out. Root mean square of what the estimate leaves of w, before (w_hat = 0), after and beyond: \
         {}\u{a0}N\u{a0}m on the smooth plant, {}\u{a0}N\u{a0}m on the backlash shaft. The paper's observer drives the load's \
         error to zero by way of an estimate that is far from w on the way, further than none. Beyond, the estimate is wrong at \
         the start, while the motor jumps faster than an observer of 60 rad/s follows and the gap is not yet identified, and on \
         the line from 2 s on.",
        rms(&runs.smooth),
        rms(&runs.shaft),
    );
    let (smooth, shaft) = (&telemetered(&runs.smooth), &telemetered(&runs.shaft));
    Figure::new("Figure 14: disturbing torque made linear", caption, 2)
        .panel(linear("Smooth plant", smooth))
        .panel(linear("Backlash shaft", shaft))
        .panel(left_over("Smooth plant: what is left of w", smooth))
        .panel(left_over("Backlash shaft: what is left of w", shaft))
}

/// What the drive takes the transmitted torque for once the disturbing part is compensated, against the twist.
fn linear(title: &str, laws: &Laws) -> Panel {
    let twist = (Axis::new("twist z", "rad"), |row: &TraceRow| row.twist_rad);
    let linear = |row: &TraceRow| row.transmitted_torque_nm - row.disturbing_torque_estimate_nm;
    let panel = each(title, twist, (Axis::new("C \u{2212} w_hat", "N m"), linear), laws.each());
    let rows = laws.each().into_iter().flat_map(|(_, _, run)| &run.rows);
    let ends = rows.fold([(f64::MAX, 0.0), (f64::MIN, 0.0)], |[low, high]: [(f64, f64); 2], row| {
        let point = (row.twist_rad, row.transmitted_torque_nm - row.disturbing_torque_nm);
        [if point.0 < low.0 { point } else { low }, if point.0 > high.0 { point } else { high }]
    });
    let (x, y) = ends.into_iter().unzip();
    panel.series(Series::new("C0 = K z", Role::Reference, x, y))
}

fn left_over(title: &str, laws: &Laws) -> Panel {
    let left = |row: &TraceRow| row.disturbing_torque_nm - row.disturbing_torque_estimate_nm;
    over_time(title, Axis::new("w \u{2212} w_hat", "N m"), laws.each(), left)
}
