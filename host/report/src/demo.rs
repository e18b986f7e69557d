//! The picture of `lashloop demo`: what the compensation changes, on the paper's smooth plant and with friction.
//!
//! It answers figures 7, 15 and 17 of Merzouki and Cadiou (Control Engineering Practice 13, 2005, 973-983) and
//! sets our measured numbers beside theirs, also where ours say something else.

use crate::plot::{Axis, Figure, Panel, Role, Series};

/// The band around the target within which the load counts as settled, in rad. The paper names none; with this one the
/// uncompensated transient lasts its 13 s.
const SETTLED_RAD: f64 = 0.05;

/// One run of the demo; the vectors hold one value per sample.
#[derive(Debug, Clone, PartialEq)]
pub struct DemoRun {
    /// Time since the step, in s.
    pub time_s: Vec<f64>,
    /// Load position, in rad.
    pub load_position_rad: Vec<f64>,
    /// Control torque on the motor, in N m.
    pub torque_nm: Vec<f64>,
    /// Estimate of the dead-zone amplitude, in rad.
    pub dead_zone_estimate_rad: Vec<f64>,
    /// Time from which the load stays within 0.05 rad of the target, in s; `None` if it never does.
    pub settle_time_s: Option<f64>,
    /// Mean position error over the last second, in rad.
    pub static_error_rad: f64,
}

/// The two runs on one plant.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantRuns {
    /// Under the PD cascade alone.
    pub before: DemoRun,
    /// Under the cascade with the estimated dead zone compensated.
    pub after: DemoRun,
}

/// All runs of the demo.
#[derive(Debug, Clone, PartialEq)]
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
    let smooth_position =
        settle_mark(position("Load position, smooth plant", smooth), Role::Before, &smooth.before, "13 s");
    let friction_position = static_mark(
        position("Load position, with friction", friction),
        Role::Before,
        &friction.before,
        "0.32 rad",
    );
    Figure::new("Gear backlash, before and after compensation", caption(runs), 2)
        .panel(settle_mark(smooth_position, Role::After, &smooth.after, "5.2 s"))
        .panel(static_mark(friction_position, Role::After, &friction.after, "eliminated"))
        .panel(estimate(runs))
        .panel(both("Control torque, with friction", Axis::new("torque", "N m"), friction, |run| {
            &run.torque_nm
        }))
}

/// A panel over time with one curve before and one after; `quantity` picks what to draw.
fn both(title: &str, y_axis: Axis, plant: &PlantRuns, quantity: impl Fn(&DemoRun) -> &Vec<f64>) -> Panel {
    let curve =
        |label, role, run: &DemoRun| Series::new(label, role, run.time_s.clone(), quantity(run).clone());
    Panel::new(title, Axis::new("time", "s"), y_axis)
        .series(curve("before", Role::Before, &plant.before))
        .series(curve("after", Role::After, &plant.after))
}

fn position(title: &str, plant: &PlantRuns) -> Panel {
    both(title, Axis::new("load position", "rad"), plant, |run| &run.load_position_rad).band(
        format!("\u{b1}{SETTLED_RAD} rad"),
        -SETTLED_RAD,
        SETTLED_RAD,
    )
}

/// Marks where the run settles, with the paper's time beside ours; a run that never does is marked at its end.
fn settle_mark(panel: Panel, role: Role, run: &DemoRun, paper: &str) -> Panel {
    let Some(settle_s) = run.settle_time_s else {
        return end_mark(panel, role, run, format!("never settles (paper: {paper})"));
    };
    let sample = run.time_s.partition_point(|&time_s| time_s < settle_s);
    let Some(&settled_rad) = run.load_position_rad.get(sample) else {
        return panel;
    };
    panel.mark(format!("{settle_s:.1} s (paper: {paper})"), role, settle_s, settled_rad)
}

/// Marks the end of the run with its static error, and the paper's beside it.
fn static_mark(panel: Panel, role: Role, run: &DemoRun, paper: &str) -> Panel {
    end_mark(panel, role, run, format!("{} (paper: {paper})", radians(run.static_error_rad)))
}

fn end_mark(panel: Panel, role: Role, run: &DemoRun, label: String) -> Panel {
    match run.time_s.last().zip(run.load_position_rad.last()) {
        Some((&end_s, &end_rad)) => panel.mark(label, role, end_s, end_rad),
        None => panel,
    }
}

fn estimate(runs: &DemoRuns) -> Panel {
    let curve = |label, role, run: &DemoRun| {
        Series::new(label, role, run.time_s.clone(), run.dead_zone_estimate_rad.clone())
    };
    let time_s = &runs.smooth.after.time_s;
    let ends_s: Vec<f64> = time_s.first().into_iter().chain(time_s.last()).copied().collect();
    let set = format!("set on the plant: {} rad", runs.dead_zone_rad);
    Panel::new("Dead-zone estimate, after", Axis::new("time", "s"), Axis::new("dead-zone amplitude", "rad"))
        .series(curve("smooth", Role::After, &runs.smooth.after))
        .series(curve("with friction", Role::Other(0), &runs.friction.after))
        .series(Series::new(set, Role::Reference, ends_s, vec![runs.dead_zone_rad; 2]))
}

fn caption(runs: &DemoRuns) -> String {
    let DemoRuns { smooth, friction, dead_zone_rad } = runs;
    let end_of =
        |run: &DemoRun| run.dead_zone_estimate_rad.last().copied().map_or("nothing".to_owned(), radians);
    format!(
        "The load returns to zero from rest. Before: PD cascade alone. After: the same cascade with the dead zone estimated \
         and compensated.\n\
         a) Time to stay within \u{b1}{SETTLED_RAD} rad: paper about 13 s before, 5.2 s after; here {} and {}.\n\
         b) Static error: paper about 0.32 rad before, eliminated after; here {} and {}.\n\
         c) Estimate at the end: {} on the smooth plant, where {dead_zone_rad} rad is set; {} with friction, which it \
         takes up too.\n\
         Band width and friction are fitted to the paper's two numbers before; those after follow.",
        seconds(smooth.before.settle_time_s),
        seconds(smooth.after.settle_time_s),
        radians(friction.before.static_error_rad),
        radians(friction.after.static_error_rad),
        end_of(&smooth.after),
        end_of(&friction.after),
    )
}

fn seconds(time_s: Option<f64>) -> String {
    time_s.map_or("never".to_owned(), |time_s| format!("{time_s:.2} s"))
}

fn radians(angle_rad: f64) -> String {
    // Rounded first, so that a tiny negative angle doesn't read "-0.000".
    let angle_rad = (angle_rad * 1000.0).round() / 1000.0 + 0.0;
    format!("{angle_rad:.3} rad").replace('-', "\u{2212}")
}
