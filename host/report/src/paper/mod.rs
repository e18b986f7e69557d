//! The figures of the paper, drawn again: figures 5 and 7 to 17 of Merzouki and Cadiou (Control Engineering Practice 13,
//! 2005, 973-983), with axes and units as there, and our numbers in the captions.
//!
//! Each shows three laws on the same plant: the PD cascade ("before"), the paper's compensation ("after") and the law that
//! inverts the gap in the torque domain ("beyond"). A figure that does not come out as the paper says shows that too, and its
//! caption says so.
//!
//! | figure | file | of |
//! |---|---|---|
//! | 5, 14 | `dead_zone` | transmitted torque, disturbing torque |
//! | 7 to 12 | `simulation` | load and motor on the smooth plant |
//! | 13 | `hysteresis` | motor against load |
//! | 15 to 17 | `experiment` | load and torque with friction |
//! | | `table` | the numbers, paper beside here |
//! | | `page` | all of it as one page |

mod curves;
mod dead_zone;
mod experiment;
mod hysteresis;
mod page;
mod simulation;
mod table;
#[cfg(test)]
mod tests;

use super::{Figure, Role};
use lashloop_bench::record::trace::TraceRow;
use lashloop_plant::metrics::Metrics;

pub use page::{file_name, page};
pub use table::{Table, tables};

/// One run.
#[derive(Debug, Clone)]
pub struct Run {
    /// The steps to draw.
    pub rows: Vec<TraceRow>,
    /// What the whole run is worth.
    pub metrics: Metrics,
}

/// The three laws on one plant.
#[derive(Debug, Clone)]
pub struct Laws {
    /// The PD cascade.
    pub before: Run,
    /// The cascade with the paper's compensation.
    pub after: Run,
    /// The law that inverts the gap in the torque domain.
    pub beyond: Run,
}

/// Everything the figures are drawn from.
#[derive(Debug, Clone)]
pub struct Runs {
    /// The paper's simulation: smooth dead zone, viscous friction.
    pub smooth: Laws,
    /// Its experiment at its simplest: hard gap, Coulomb friction.
    pub friction: Laws,
    /// Its experiment as it is built: physical backlash, Stribeck friction, lag, delay, coarse encoders.
    pub bench: Laws,
    /// The same under a slow sine; the rows are those of its last period.
    pub sine: Laws,
    /// The smooth plant at rest, twisted by one angle after the other.
    pub smooth_gap: Vec<TraceRow>,
    /// The bench at rest, likewise.
    pub hard_gap: Vec<TraceRow>,
    /// Reduction ratio N0 of them all.
    pub ratio: f64,
}

impl Laws {
    /// Name and role of each law in the legends, with its run.
    fn each(&self) -> [(&'static str, Role, &Run); 3] {
        [
            ("before: PD", Role::Before, &self.before),
            ("after: compensation", Role::After, &self.after),
            ("beyond: gap inverted", Role::Other(0), &self.beyond),
        ]
    }
}

/// The figures with their numbers in the paper.
pub fn figures(runs: &Runs) -> Vec<(u8, Figure)> {
    let mut figures = vec![
        (5, dead_zone::transmitted_torque(runs)),
        (13, hysteresis::motor_against_load(runs)),
        (14, dead_zone::made_linear(runs)),
    ];
    figures.extend(simulation::figures(&runs.smooth));
    figures.extend(experiment::figures(runs));
    figures.sort_by_key(|(number, _)| *number);
    figures
}
