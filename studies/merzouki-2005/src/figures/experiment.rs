//! Figures 15 to 17: load and torque with friction, on the two plants that stand for the paper's experiment.

use lashloop_plant::metrics::Metric;
use lashloop_plot::{Axis, Figure, Panel};

use super::curves::{column, mark_static_error, of, over_time, three};
use super::laws::{Laws, Runs};

const FRICTION: &str = "Hard gap, Coulomb friction";
const SHAFT: &str = "Backlash shaft";

pub(super) fn figures(runs: &Runs) -> [(u8, Figure); 3] {
    [(15, load_position(runs)), (16, load_velocity(runs)), (17, torque(runs))]
}

fn load_position(runs: &Runs) -> Figure {
    let panel = |title, laws: &Laws, paper| {
        let axis = Axis::new("load position", "rad");
        let panel = over_time(title, axis, laws.each(), column("load_position_rad"));
        mark_static_error(panel, laws.each(), paper)
    };
    let caption = format!(
        "The paper: a static error of about 0.32 rad before; eliminated after, and oscillations gone.\n\
         Here: static error before, after and beyond {} rad with Coulomb friction, {} rad on the backlash shaft. The friction is \
         fitted to 0.32 rad; the error after is a prediction. The paper's compensation overshoots by {} and {} rad and comes to \
         rest some milliradians off.",
        three(&runs.friction, Metric::StaticError, 4),
        three(&runs.shaft, Metric::StaticError, 4),
        of(&runs.friction.after, Metric::Overshoot, 2),
        of(&runs.shaft.after, Metric::Overshoot, 2),
    );
    Figure::new("Figure 15: load position, experiment", caption, 2)
        .panel(panel(FRICTION, &runs.friction, [" (paper: 0.32 rad)", " (paper: eliminated)", ""]))
        .panel(panel(SHAFT, &runs.shaft, ["", "", ""]))
}

fn load_velocity(runs: &Runs) -> Figure {
    let caption = "The paper: the velocity oscillates before, and no longer after.\n\
                   Here: before, the load stops early and sticks, without oscillating; after, the load \
                   reverses twice on its way to zero; beyond, not at all.";
    both("Figure 16: load velocity, experiment", caption, runs, |title, laws| {
        over_time(title, Axis::new("load velocity", "rad/s"), laws.each(), column("load_velocity_rad_s"))
    })
}

fn torque(runs: &Runs) -> Figure {
    let caption = format!(
        "The paper: the control signal is cleaner after, and converges to its minimum.\n\
         Here: by its total variation, before, after and beyond: {}\u{a0}N\u{a0}m with Coulomb friction and fine \
         encoders, {}\u{a0}N\u{a0}m on the backlash shaft. So it is a little cleaner with fine encoders only. With 4000 counts the \
         velocity gains of the two cascades pass every count on to the motor, before and after; the law beyond has an observer \
         instead. After, the torque does not come to rest: the estimate moves on while the load sticks.",
        three(&runs.friction, Metric::TorqueTotalVariation, 0),
        three(&runs.shaft, Metric::TorqueTotalVariation, 0),
    );
    both("Figure 17: control signal, experiment", &caption, runs, |title, laws| {
        over_time(title, Axis::new("torque", "N m"), laws.each(), column("torque_nm"))
    })
}

fn both(title: &str, caption: &str, runs: &Runs, panel: impl Fn(&str, &Laws) -> Panel) -> Figure {
    Figure::new(title, caption, 2).panel(panel(FRICTION, &runs.friction)).panel(panel(SHAFT, &runs.shaft))
}
