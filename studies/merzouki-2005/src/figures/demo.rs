//! The figure of `lashloop paper demo`: the effect of compensation on the paper's smooth plant and with friction.
//!
//! It corresponds to figures 7, 15 and 17 of Merzouki and Cadiou (Control Engineering Practice 13, 2005, 973-983) and gives
//! our numbers next to the paper's, also where they differ.

use super::curves::{
    Curve, DEAD_ZONE_ESTIMATE_RAD, column, fixed, mark_settling, mark_static_error, of, over_time,
};
use super::laws::Run;
use lashloop_plant::metrics::{Metric, SETTLED_RAD};
use lashloop_plot::{Axis, Figure, Panel, Role, Series};

/// The two runs on one plant.
#[derive(Debug, Clone)]
pub struct PlantRuns {
    /// Under the PD cascade alone.
    pub before: Run,
    /// Under the cascade with the estimated dead zone compensated.
    pub after: Run,
}

impl PlantRuns {
    /// Name and role of each run in the legends, with the run.
    fn each(&self) -> [Curve<'_>; 2] {
        [("before", Role::Before, &self.before), ("after", Role::After, &self.after)]
    }
}

/// All runs of the demo.
#[derive(Debug, Clone)]
pub struct DemoRuns {
    /// The paper's plant: smooth dead zone, viscous friction.
    pub smooth: PlantRuns,
    /// Hard dead zone with Coulomb friction on the load.
    pub friction: PlantRuns,
    /// Dead-zone amplitude set on both plants, in rad.
    pub dead_zone_rad: f64,
}

/// Four panels: load position on either plant, dead-zone estimate on both, control torque with friction.
pub fn before_after(runs: &DemoRuns) -> Figure {
    let DemoRuns { smooth, friction, .. } = runs;
    let torque = Axis::new("torque", "N m");
    Figure::new("Gear backlash, before and after compensation", caption(runs), 2)
        .panel(mark_settling(
            position("Load position, smooth plant", smooth),
            smooth.each(),
            [" (paper: 13 s)", " (paper: 5.2 s)"],
        ))
        .panel(mark_static_error(
            position("Load position, with friction", friction),
            friction.each(),
            [" (paper: 0.32 rad)", " (paper: eliminated)"],
        ))
        .panel(estimate(runs))
        .panel(over_time("Control torque, with friction", torque, friction.each(), column("torque_nm")))
}

fn position(title: &str, plant: &PlantRuns) -> Panel {
    over_time(title, Axis::new("load position", "rad"), plant.each(), column("load_position_rad")).band(
        format!("\u{b1}{SETTLED_RAD} rad"),
        -SETTLED_RAD,
        SETTLED_RAD,
    )
}

fn estimate(runs: &DemoRuns) -> Panel {
    let DemoRuns { smooth, friction, dead_zone_rad } = runs;
    let curves = [("smooth", Role::After, &smooth.after), ("with friction", Role::Other(0), &friction.after)];
    let time_s = smooth.after.column("time_s");
    let ends_s: Vec<f64> = time_s.first().into_iter().chain(time_s.last()).copied().collect();
    let set = format!("set on the plant: {dead_zone_rad} rad");
    let axis = Axis::new("dead-zone amplitude", "rad");
    over_time("Dead-zone estimate, after", axis, curves, column(DEAD_ZONE_ESTIMATE_RAD)).series(Series::new(
        set,
        Role::Reference,
        ends_s,
        vec![*dead_zone_rad; 2],
    ))
}

fn caption(runs: &DemoRuns) -> String {
    let DemoRuns { smooth, friction, dead_zone_rad } = runs;
    let end_of = |run: &Run| match run.column(DEAD_ZONE_ESTIMATE_RAD).last() {
        Some(estimate_rad) => format!("{} rad", fixed(*estimate_rad, 3)).replace('-', "\u{2212}"),
        None => "nothing".to_owned(),
    };
    let settled = |run: &Run| match run.metrics.get(Metric::SettleTime).value() {
        Some(time_s) => format!("{time_s:.2} s"),
        None => "never".to_owned(),
    };
    let static_error = |run| format!("{} rad", of(run, Metric::StaticError, 3));
    format!(
        "The load returns to zero from rest. Before: PD cascade alone. After: the same cascade with the dead zone estimated \
         and compensated.\n\
         a) Time to stay within \u{b1}{SETTLED_RAD} rad: paper about 13 s before, 5.2 s after; here {} and {}.\n\
         b) Static error: paper about 0.32 rad before, eliminated after; here {} and {}.\n\
         c) Estimate at the end: {} on the smooth plant, where {dead_zone_rad} rad is set; {} with friction, which it \
         takes up too.\n\
         Band width and friction are fitted to the paper's two numbers before; those after follow.",
        settled(&smooth.before),
        settled(&smooth.after),
        static_error(&friction.before),
        static_error(&friction.after),
        end_of(&smooth.after),
        end_of(&friction.after),
    )
}

#[cfg(test)]
mod tests;
