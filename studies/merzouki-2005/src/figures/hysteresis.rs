//! Figure 13: motor against load position, for the step of the paper and for a slow sine.

use lashloop_plant::metrics::{Measured, Metric};
use lashloop_plot::{Axis, Figure};

use super::curves::{column, each, of, written};
use super::laws::{Laws, Run, Runs};

/// Thickness of the loop of motor against load position: the range of z / N0, both positions referred to the load.
pub(super) fn thickness(run: &Run, ratio: f64) -> Measured {
    let twists_rad = run.column("twist_rad");
    let twists_rad = || twists_rad.iter().copied();
    match (twists_rad().reduce(f64::min), twists_rad().reduce(f64::max)) {
        // `min` and `max` ignore NaN and would return a number.
        _ if !run.metrics.run_was_finite() => Measured::NotFinite,
        (Some(low_rad), Some(high_rad)) => Measured::Value((high_rad - low_rad) / ratio),
        _ => Measured::RunTooShort,
    }
}

pub(super) fn motor_against_load(runs: &Runs) -> Figure {
    let Runs { smooth, sine, ratio, .. } = runs;
    let thick = |laws: &Laws| laws.each().map(|(_, _, run)| written(thickness(run, *ratio), 3)).join(", ");
    let lost = |run| of(run, Metric::LostMotion, 4);
    let caption = format!(
        "The paper: the thickness of the hysteresis shrinks after compensation.\n\
         Here: not in the step, a) and b). The loop is as thick as the spring is wound up, {} rad before, after and beyond, and a \
         faster law winds it up more. It comes out where hysteresis is measured as lost motion, under a slow sine on the backlash \
         shaft, c) and d): the load passes the middle of its way at places {} rad apart before, {} rad after, {} rad beyond.",
        thick(smooth),
        lost(&sine.before),
        lost(&sine.after),
        lost(&sine.beyond),
    );
    let ratio = *ratio;
    let load = || (Axis::new("load position", "rad"), column("load_position_rad"));
    let motor = || (Axis::new("motor position", "rad"), column("motor_position_rad"));
    let at_load =
        move |run: &Run| run.column("twist_rad").iter().map(|twist_rad| twist_rad / ratio).collect();
    let twist = (Axis::new("motor less load, at the load", "rad"), at_load);
    let reference = (Axis::new("reference", "rad"), column("reference_rad"));
    Figure::new("Figure 13: hysteresis", caption, 2)
        .panel(each("Step on the smooth plant", load(), motor(), smooth.each()))
        .panel(each("Step: thickness of the loop", load(), twist, smooth.each()))
        .panel(each("Slow sine on the backlash shaft, last period", load(), motor(), sine.each()))
        .panel(each("Slow sine: load against reference", reference, load(), sine.each()))
}
