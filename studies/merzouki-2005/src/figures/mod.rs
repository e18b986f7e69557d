//! The figures of the paper, reproduced: figures 5 and 7 to 17 of Merzouki and Cadiou (Control Engineering Practice 13, 2005,
//! 973-983), with the paper's axes and units, and our numbers in the captions.
//!
//! Each figure shows three laws on the same plant: the PD cascade ("before"), the paper's compensation ("after") and the law
//! that inverts the gap in the torque domain ("beyond the paper"). A caption states where our result differs from the paper.
//!
//! | figure | file | of |
//! |---|---|---|
//! | 5, 14 | `dead_zone` | transmitted torque, disturbing torque |
//! | 7 to 12 | `simulation` | load and motor on the smooth plant |
//! | 13 | `hysteresis` | motor against load |
//! | 15 to 17 | `experiment` | load and torque with friction |
//! | | [`demo`] | the figure of the demo |
//! | | `table` | the numbers, the paper's next to ours |
//! | | `comparison` | figures 7 and 15 to 17 and the numbers, simulation next to experiment |
//! | | `page` | figures and tables as one HTML page |

mod comparison;
mod curves;
mod dead_zone;
pub mod demo;
mod experiment;
mod hysteresis;
mod laws;
mod page;
mod simulation;
mod table;
#[cfg(test)]
mod tests;

use lashloop_plot::Figure;

pub use comparison::{BeforeAfter, Compared, Experiment, comparison_figures, comparison_table};
pub use laws::{Laws, Run, Runs};
pub use page::{COMPARISON, PAPER, file_name, page};
pub use table::{Table, tables};

/// The figures, each with its number in the paper.
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
