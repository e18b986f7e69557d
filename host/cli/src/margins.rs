//! `lashloop margins`: how far the plant may differ from the one that the law is told of.

use std::path::PathBuf;

use clap::Args;
use lashloop::Bench;
use lashloop::margins::{Margins, margins};
use lashloop_bench::run::End;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;
use lashloop_plant::reference::Reference;

use super::error::CliError;
use super::options::plants;
use super::output::{error_line, outln};
use super::supervision::start_supervisor;

/// Simulate a scenario with other plants, until the load no longer settles
///
/// The law of this program closes the loop in process. Inertia of the load, stiffness and delay of the torque leave their values
/// one at a time, in steps of 1.3 up to 8.2 and of up to 255 periods. A load has settled if it stays within 5 % of its move and, over
/// the last 10 s, within two counts and the noise of its encoder. Exit code 1 if it doesn't settle with the plant as stated.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario with a constant reference
    scenario: PathBuf,

    /// Value instead of the scenario's, such as controller.parameters.pace=0.7; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let overrides: Vec<_> = self.set.into_iter().map(Override::Set).collect();
        let scenario = Scenario::from_file_with(&self.scenario, &overrides, &plants(bench))?;
        if !matches!(scenario.reference, Reference::Constant { .. }) {
            return Err(CliError::NotConstant { path: self.scenario });
        }
        let supervisor = start_supervisor()?;
        let Some(found) = of(bench, &supervisor, &scenario)? else { return Ok(Exit::Invalid) };
        Ok(if found.settle_time_s.is_some() { Exit::Pass } else { Exit::Fail })
    }
}

/// Finds and prints the margins of a scenario; `None` if a signal of the user ends the search.
pub(super) fn of(
    bench: &Bench,
    supervisor: &Supervisor,
    scenario: &Scenario,
) -> Result<Option<Margins>, CliError> {
    let _signals = supervisor.guard_signals();
    let found = margins(bench, supervisor, scenario)?;
    match &found {
        Some(Margins { end, settle_time_s, margins }) => {
            match settle_time_s {
                Some(it) => outln!("simulation           settles within 5 % after {it:.2} s"),
                None if *end == End::Complete => {
                    outln!("simulation           the load doesn't settle, or hunts, so it has no margins");
                }
                None => outln!("simulation           {end}, so the load has no margins"),
            }
            margins.iter().for_each(|it| outln!("margin               {it}"));
        }
        None => error_line(format_args!("INVALID: interrupted by the user before all margins were found")),
    }
    Ok(found)
}
