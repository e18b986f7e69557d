//! The figure of `lashloop paper demo`: the paper's smooth plant and the one with friction, before and after compensation,
//! and under the law beyond the paper.
//!
//! It corresponds to figures 7, 15 and 17 of Merzouki and Cadiou (Control Engineering Practice 13, 2005, 973-983) and gives
//! our numbers next to the paper's, also where they differ. All laws of a plant have its scenario: start, encoders, period
//! and torque limit. The law beyond the paper keeps its default parameters.

use super::curves::{
    DEAD_ZONE_DEVIATION_RAD, DEAD_ZONE_ESTIMATE_RAD, column, fixed, mark_end, mark_settling,
    mark_static_error, of, over_time,
};
use super::laws::{Laws, Run};
use lashloop_plant::metrics::{Metric, SETTLED_RAD};
use lashloop_plot::{Axis, Figure, Panel, Role, Series};

/// All runs of the demo.
#[derive(Debug, Clone)]
pub struct DemoRuns {
    /// The paper's plant: smooth dead zone, viscous friction.
    pub smooth: Laws,
    /// Hard dead zone with Coulomb friction on the load.
    pub friction: Laws,
    /// Dead-zone amplitude set on both plants, in rad.
    pub dead_zone_rad: f64,
}

/// Four panels: load position on either plant, dead-zone estimate on both, control torque with friction.
pub fn before_after(runs: &DemoRuns) -> Figure {
    let DemoRuns { smooth, friction, .. } = runs;
    let torque = Axis::new("torque", "N m");
    Figure::new("Gear backlash: before and after compensation, and beyond the paper", caption(runs), 2)
        .panel(mark_settling(
            position("Load position, smooth plant", smooth),
            smooth.each(),
            [" (paper: 13 s)", " (paper: 5.2 s)", ""],
        ))
        .panel(mark_static_error(
            position("Load position, with friction", friction),
            friction.each(),
            [" (paper: 0.32 rad)", " (paper: eliminated)", ""],
        ))
        .panel(estimate(runs))
        .panel(over_time("Control torque, with friction", torque, friction.each(), column("torque_nm")))
}

fn position(title: &str, plant: &Laws) -> Panel {
    over_time(title, Axis::new("load position", "rad"), plant.each(), column("load_position_rad")).band(
        format!("\u{b1}{SETTLED_RAD} rad"),
        -SETTLED_RAD,
        SETTLED_RAD,
    )
}

/// Without friction the paper's estimate returns to the truth, with friction it does not: the panel shows both.
fn estimate(runs: &DemoRuns) -> Panel {
    let DemoRuns { smooth, friction, dead_zone_rad } = runs;
    let (after, beyond) = (&friction.after, &friction.beyond);
    let beyond_role = Role::Other(0);
    let curves = [
        ("after, smooth plant", Role::Line { colour: 0, dash: 2 }, &smooth.after),
        ("after, with friction", Role::After, after),
    ];
    let time_s = beyond.column("time_s");
    let ends_s: Vec<f64> = time_s.first().into_iter().chain(time_s.last()).copied().collect();
    let name = "braking-curve \u{b1} deviation, with friction";
    let shaded = Series::new(name, beyond_role, time_s, beyond.column(DEAD_ZONE_ESTIMATE_RAD))
        .deviation(beyond.column(DEAD_ZONE_DEVIATION_RAD));
    let set = format!("set: {dead_zone_rad} rad");
    let axis = Axis::new("dead-zone amplitude", "rad");
    let panel = over_time("Dead-zone estimate", axis, curves, column(DEAD_ZONE_ESTIMATE_RAD))
        .series(shaded)
        .series(Series::new(set, Role::Reference, ends_s, vec![*dead_zone_rad; 2]));
    let reason = format!("{}: load friction taken for gap", end_rad(after, DEAD_ZONE_ESTIMATE_RAD, 2));
    let panel = mark_end(panel, Role::After, after, DEAD_ZONE_ESTIMATE_RAD, &reason);
    let [estimate, deviation] =
        [DEAD_ZONE_ESTIMATE_RAD, DEAD_ZONE_DEVIATION_RAD].map(|name| end_rad(beyond, name, 2));
    let label = format!("{estimate} \u{b1} {deviation}");
    mark_end(panel, beyond_role, beyond, DEAD_ZONE_ESTIMATE_RAD, &label)
}

/// The last value of a column, formatted.
fn end_rad(run: &Run, name: &str, decimals: usize) -> String {
    match run.column(name).last() {
        Some(value_rad) => format!("{} rad", fixed(*value_rad, decimals)).replace('-', "\u{2212}"),
        None => "nothing".to_owned(),
    }
}

fn caption(runs: &DemoRuns) -> String {
    let DemoRuns { smooth, friction, dead_zone_rad } = runs;
    let estimate = |run: &Run| end_rad(run, DEAD_ZONE_ESTIMATE_RAD, 3);
    let deviation = |run: &Run| end_rad(run, DEAD_ZONE_DEVIATION_RAD, 3);
    let settled = |laws: &Laws| {
        laws.each().map(|(_, _, run)| match run.metrics.get(Metric::SettleTime).value() {
            Some(time_s) => format!("{time_s:.2} s"),
            None => "never".to_owned(),
        })
    };
    let [before_settled, after_settled, beyond_settled] = settled(smooth);
    let [before_rad, after_rad, beyond_rad] =
        friction.each().map(|(_, _, run)| of(run, Metric::StaticError, 3));
    format!(
        "The load returns to zero from rest. Before: PD cascade alone. After: the same cascade with the dead zone estimated \
         and compensated. Beyond the paper: braking-curve, a law of Lashloop's own, which also has the load's nominal \
         friction and plans with the torque limit; plant, start, encoders and limit are the same.\n\
         a) Time to stay within \u{b1}{SETTLED_RAD} rad: paper about 13 s before, 5.2 s after; here {before_settled} and \
         {after_settled}, beyond {beyond_settled}.\n\
         b) Static error: paper about 0.32 rad before, eliminated after; here {before_rad} and {after_rad} rad, beyond {beyond_rad} rad.\n\
         c) Each estimate starts at the {dead_zone_rad} rad that is set. The paper's observer integrates whatever keeps the \
         load from its target: its estimate ends at {} on the smooth plant; with friction the load sticks, and the estimate \
         moves on to {}. That of braking-curve ends at {} with a deviation of {}; on the smooth plant, whose gap has no flanks, \
         its deviation stays at {}.\n\
         Band width and friction are fitted to the paper's two numbers before; those after follow.",
        estimate(&smooth.after),
        estimate(&friction.after),
        estimate(&friction.beyond),
        deviation(&friction.beyond),
        deviation(&smooth.beyond),
    )
}

#[cfg(test)]
mod tests;
