//! Figures 7 to 12: load and motor on the paper's smooth plant, from rest at pi/2 rad to zero.

use lashloop_plant::metrics::{Metric, SETTLED_RAD};
use lashloop_plot::{Axis, Figure};

use super::curves::{
    MOTOR_ERROR_RAD, column, from, load_error_rad, mark_settling, of, over_time, telemetered, within,
};
use super::laws::Laws;

/// Range of the second panel of figure 8, in rad.
const NEAR_LOAD_RAD: f64 = 0.2;

pub(super) fn figures(smooth: &Laws) -> [(u8, Figure); 6] {
    [
        (7, load_position(smooth)),
        (8, load_error(smooth)),
        (9, load_velocity(smooth)),
        (10, motor_position(smooth)),
        (11, motor_error(smooth)),
        (12, motor_velocity(smooth)),
    ]
}

fn load_position(smooth: &Laws) -> Figure {
    let Laws { before, after, beyond } = smooth;
    let panel = over_time(
        "Smooth plant",
        Axis::new("load position", "rad"),
        smooth.each(),
        column("load_position_rad"),
    );
    let panel = panel.band(format!("\u{b1}{SETTLED_RAD} rad"), -SETTLED_RAD, SETTLED_RAD);
    let caption = format!(
        "The paper: a transient of about 13 s before, 5.2 s after.\n\
         Here: {} s and {} s until the load stays within \u{b1}{SETTLED_RAD} rad; {} s beyond. The paper names no band: with this \
         one its 13 s come out, and its 5.2 s follow. After compensation the load overshoots by {} rad, which the paper does \
         not report.",
        of(before, Metric::SettleTime, 2),
        of(after, Metric::SettleTime, 2),
        of(beyond, Metric::SettleTime, 2),
        of(after, Metric::Overshoot, 3),
    );
    let paper = [" (paper: about 13 s)", " (paper: about 5.2 s)", ""];
    Figure::new("Figure 7: load position, simulation", caption, 1).panel(mark_settling(
        panel,
        smooth.each(),
        paper,
    ))
}

fn load_error(smooth: &Laws) -> Figure {
    let Laws { before, after, beyond } = smooth;
    let axis = || Axis::new("load position error", "rad");
    let near = over_time("The same near zero", axis(), smooth.each(), within(NEAR_LOAD_RAD, load_error_rad));
    let caption = format!(
        "The paper: the error goes to zero in about 13 s before, in 5.2 s after.\n\
         Here: after 25 s the mean of the last second is {} rad before, {} rad after and {} rad beyond. Before, the load still \
         creeps: near the middle of the smooth gap the spring transmits next to nothing. Beyond, the law \
         stops within 2 mrad and leaves the rest to friction; this plant has none, so the load drifts on.",
        of(before, Metric::StaticError, 4),
        of(after, Metric::StaticError, 4),
        of(beyond, Metric::StaticError, 4),
    );
    Figure::new("Figure 8: load position error, simulation", caption, 2)
        .panel(over_time("Smooth plant", axis(), smooth.each(), load_error_rad))
        .panel(near.band(format!("\u{b1}{SETTLED_RAD} rad"), -SETTLED_RAD, SETTLED_RAD))
}

fn load_velocity(smooth: &Laws) -> Figure {
    let caption = "The paper: the velocity goes to zero, sooner and more smoothly after.\n\
                   Here: sooner, but the load reverses repeatedly, which is the ringing of figure 7. Beyond, the load arrives \
                   without a reversal; the law limits the load's speed to 1.5 rad/s.";
    let axis = Axis::new("load velocity", "rad/s");
    let panel = over_time("Smooth plant", axis, smooth.each(), column("load_velocity_rad_s"));
    Figure::new("Figure 9: load velocity, simulation", caption, 1).panel(panel)
}

fn motor_position(smooth: &Laws) -> Figure {
    let caption = "The paper: the motor arrives faster, with smooth transitions, after.\n\
                   Here: neither. Before, the motor is near zero in 2 s, while the load still creeps. After, the motor crosses \
                   the gap at each reversal of the load, and swings on the spring. Beyond, the motor crosses twice and stops, \
                   except for a ripple in the slack middle of this gap; the hard gaps of figure 17 have none.";
    let axis = Axis::new("motor position", "rad");
    let panel = over_time("Smooth plant", axis, smooth.each(), column("motor_position_rad"));
    Figure::new("Figure 10: motor position, simulation", caption, 1).panel(panel)
}

fn motor_error(smooth: &Laws) -> Figure {
    let axis = || Axis::new("motor position error", "rad");
    let error = || column(MOTOR_ERROR_RAD);
    let telemetered_laws = &telemetered(smooth);
    let caption = "The paper: the motor's error goes to zero, sooner after.\n\
                   Here: as sent by the drive: motor position minus the set point of its load loop. The set point of the two cascades \
                   is ten times the load's error, hence 20 rad at the start; the law beyond adds a twist to the load's \
                   position. After, the error is sooner near zero, with the same swings as the motor. The fringe stems from the \
                   load's velocity, which is formed from counts.";
    Figure::new("Figure 11: motor position error, simulation", caption, 2)
        .panel(over_time("Smooth plant", axis(), telemetered_laws.each(), error()))
        .panel(over_time("The same from 5 s on", axis(), telemetered_laws.each(), from(5.0, error())))
}

fn motor_velocity(smooth: &Laws) -> Figure {
    let axis = || Axis::new("motor velocity", "rad/s");
    let velocity = || column("motor_velocity_rad_s");
    let caption = "The paper: the velocity goes to zero, sooner and more smoothly after.\n\
                   Here: not more smoothly. After, the light motor crosses the gap fast and swings on the spring at each \
                   reversal of the load. Panel b) omits the first second, in which the motor jumps to the set point of the load \
                   loop.";
    Figure::new("Figure 12: motor velocity, simulation", caption, 2)
        .panel(over_time("Smooth plant", axis(), smooth.each(), velocity()))
        .panel(over_time("The same from 1 s on", axis(), smooth.each(), from(1.0, velocity())))
}
