//! The paper's comparison of simulation and experiment: each run of the simulation next to the run of a real drive.
//!
//! Positions of an experiment are those of its encoders, and the velocity is the one that the drive has measured, in both.

use lashloop_plant::metrics::{Metric, SETTLED_RAD};
use lashloop_plot::{Axis, Figure, Panel, Role, Series};

use super::curves::{column, mark_settling, mark_static_error, over_time, written};
use super::laws::Run;
use super::table::Table;

/// One law on one plant, simulated and on the bench.
#[derive(Debug, Clone)]
pub struct Compared {
    /// HIL mode.
    pub simulation: Run,
    /// Bench mode.
    pub experiment: Run,
}

/// The laws of the paper on one plant.
#[derive(Debug, Clone)]
pub struct BeforeAfter {
    /// The PD cascade.
    pub before: Compared,
    /// The cascade with the paper's compensation.
    pub after: Compared,
}

/// All runs of the comparison.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Section 6 of the paper: smooth dead zone, viscous friction.
    pub smooth: BeforeAfter,
    /// Section 7 of the paper: hard gap, Coulomb friction.
    pub friction: BeforeAfter,
}

const MEASURED_VELOCITY: &str = "drive.measured_load_velocity_rad_s";
const SOURCES: &str = "Simulation: HIL mode, true positions. Experiment: bench mode, positions of the drive's encoders; a bench has \
                       no truth.";

impl Compared {
    fn each(&self) -> [(&'static str, Role, &Run); 2] {
        [("simulation", Role::Before, &self.simulation), ("experiment", Role::After, &self.experiment)]
    }

    /// Load position of the experiment less that of the simulation, in mrad, as far as both go.
    fn difference_mrad(&self) -> Vec<f64> {
        let [simulation, experiment] =
            [&self.simulation, &self.experiment].map(|run| run.column("load_position_rad"));
        experiment
            .iter()
            .zip(simulation)
            .map(|(experiment, simulation)| 1e3 * (experiment - simulation))
            .collect()
    }
}

/// The figures, each with its number in the paper.
#[must_use]
pub fn comparison_figures(runs: &Experiment) -> Vec<(u8, Figure)> {
    let Experiment { smooth, friction } = runs;
    vec![
        (
            7,
            position(
                "Figure 7: load position, smooth dead zone",
                smooth,
                |panel, run, paper| {
                    let panel = panel.band(format!("\u{b1}{SETTLED_RAD} rad"), -SETTLED_RAD, SETTLED_RAD);
                    mark_settling(panel, run.each(), [paper, ""])
                },
                [" (paper: about 13 s)", " (paper: about 5.2 s)"],
            ),
        ),
        (
            15,
            position(
                "Figure 15: load position, with friction",
                friction,
                |panel, run, paper| mark_static_error(panel, run.each(), [paper, ""]),
                [" (paper: 0.32 rad)", " (paper: eliminated)"],
            ),
        ),
        (
            16,
            both(
                "Figure 16: load velocity, with friction",
                friction,
                "load velocity",
                "rad/s",
                MEASURED_VELOCITY,
            ),
        ),
        (17, both("Figure 17: control signal, with friction", friction, "torque", "N m", "torque_nm")),
    ]
}

fn position(
    title: &str,
    runs: &BeforeAfter,
    mark: impl Fn(Panel, &Compared, &'static str) -> Panel,
    [before, after]: [&'static str; 2],
) -> Figure {
    let panel = |title, run: &Compared, paper| {
        let axis = Axis::new("load position", "rad");
        mark(over_time(title, axis, run.each(), column("load_position_rad")), run, paper)
    };
    let difference = [("before", Role::Before, &runs.before), ("after", Role::After, &runs.after)];
    let difference = difference.into_iter().fold(
        Panel::new("Experiment less simulation", Axis::new("time", "s"), Axis::new("load position", "mrad")),
        |panel, (name, role, run)| {
            let difference = run.difference_mrad();
            let mut time_s = run.simulation.column("time_s");
            time_s.truncate(difference.len());
            panel.series(Series::new(name, role, time_s, difference))
        },
    );
    Figure::new(title, SOURCES, 2)
        .panel(panel("Before compensation", &runs.before, before))
        .panel(panel("After compensation", &runs.after, after))
        .panel(difference)
}

fn both(title: &str, runs: &BeforeAfter, quantity: &str, unit: &str, name: &'static str) -> Figure {
    let panel = |title, run: &Compared| over_time(title, Axis::new(quantity, unit), run.each(), column(name));
    Figure::new(title, SOURCES, 2)
        .panel(panel("Before compensation", &runs.before))
        .panel(panel("After compensation", &runs.after))
}

/// The paper's numbers, the simulation's and the experiment's.
#[must_use]
pub fn comparison_table(runs: &Experiment) -> Table {
    let Experiment { smooth, friction } = runs;
    let lines = [
        ("smooth: time into 0.05 rad (s)", ["about 13", "about 5.2"], smooth, Metric::SettleTime, 2),
        ("smooth: static error (rad)", ["-", "-"], smooth, Metric::StaticError, 4),
        ("smooth: overshoot (rad)", ["-", "-"], smooth, Metric::Overshoot, 3),
        ("smooth: rms torque (N m)", ["-", "-"], smooth, Metric::RmsTorque, 3),
        ("friction: static error (rad)", ["about 0.32", "eliminated"], friction, Metric::StaticError, 4),
        ("friction: overshoot (rad)", ["-", "-"], friction, Metric::Overshoot, 3),
        ("friction: hunting (rad)", ["oscillates", "none"], friction, Metric::Hunting, 4),
        ("friction: torque variation (N m)", ["noisy", "cleaner"], friction, Metric::TorqueTotalVariation, 0),
        ("estimate of the gap minus the gap (rad)", ["-", "-"], smooth, Metric::DeadZoneError, 3),
    ];
    let rows = lines.into_iter().map(|(what, paper, laws, metric, decimals)| {
        let cells = paper.into_iter().zip([&laws.before, &laws.after]).flat_map(|(paper, run)| {
            let of = |run: &Run| written(run.metrics.get(metric), decimals);
            [paper.to_owned(), of(&run.simulation), of(&run.experiment)]
        });
        (what.to_owned(), cells.collect())
    });
    Table {
        title: "paper / simulation / experiment",
        columns: vec!["paper before", "simulation", "experiment", "paper after", "simulation", "experiment"],
        rows: rows.collect(),
    }
}
