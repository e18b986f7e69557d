//! Figures 5 and 14: the torque through the dead zone, and what compensation makes of it.

use lashloop_plant::metrics::Metric;
use lashloop_plot::{Axis, Figure, Panel, Role, Series};
use lashloop_record::columns::Columns;

use super::curves::{DISTURBING_TORQUE_ESTIMATE_NM, column, each, over_time, telemetered, three};
use super::laws::{Laws, Run, Runs, difference, values};

pub(super) fn transmitted_torque(runs: &Runs) -> Figure {
    let (twist_rad, torque_nm) =
        (values(&runs.hard_gap, "twist_rad"), values(&runs.hard_gap, "transmitted_torque_nm"));
    let without_torque = twist_rad.iter().zip(torque_nm).filter(|(_, torque_nm)| *torque_nm == 0.0);
    let edge_rad = without_torque.map(|(twist_rad, _)| *twist_rad).fold(0.0, f64::max);
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
fn parts(title: &str, twisted: &Columns) -> Panel {
    let curve = |label, role, torque_nm| Series::new(label, role, values(twisted, "twist_rad"), torque_nm);
    let (transmitted, disturbing) = ("transmitted_torque_nm", "disturbing_torque_nm");
    Panel::new(title, Axis::new("twist z", "rad"), Axis::new("torque", "N m"))
        .series(curve("C0 = K z", Role::Reference, difference(twisted, transmitted, disturbing)))
        .series(curve("w", Role::Before, values(twisted, disturbing)))
        .series(curve("C = C0 + w", Role::After, values(twisted, transmitted)))
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
    let twist = (Axis::new("twist z", "rad"), column("twist_rad"));
    let linear = |run: &Run| run.difference("transmitted_torque_nm", DISTURBING_TORQUE_ESTIMATE_NM);
    let panel = each(title, twist, (Axis::new("C \u{2212} w_hat", "N m"), linear), laws.each());
    let points = laws.each().into_iter().flat_map(|(_, _, run)| {
        let linear_nm = run.difference("transmitted_torque_nm", "disturbing_torque_nm");
        run.column("twist_rad").into_iter().zip(linear_nm)
    });
    let ends = points.fold([(f64::MAX, 0.0), (f64::MIN, 0.0)], |[low, high]: [(f64, f64); 2], point| {
        [if point.0 < low.0 { point } else { low }, if point.0 > high.0 { point } else { high }]
    });
    let (x, y) = ends.into_iter().unzip();
    panel.series(Series::new("C0 = K z", Role::Reference, x, y))
}

fn left_over(title: &str, laws: &Laws) -> Panel {
    let left = |run: &Run| run.difference("disturbing_torque_nm", DISTURBING_TORQUE_ESTIMATE_NM);
    over_time(title, Axis::new("w \u{2212} w_hat", "N m"), laws.each(), left)
}
