//! `lashloop margins`: how far the plant may differ from the one that the law is told of.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use clap::Args;
use lashloop::Bench;
use lashloop::margins::{Margins, margins};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::verdict::Exit;
use lashloop_hardware::identify::reach;
use lashloop_plant::reference::Reference;

use super::error::{CliError, system};
use super::options::plants;
use super::output::{outln, write_file};

/// Simulate a scenario with other plants, until the load no longer settles
///
/// The law of this program closes the loop in process. Inertia of the load, stiffness and delay of the torque leave their values
/// one at a time, in steps of 1.3 up to 8.2 and of up to 255 periods. A load that stays within 5 % of its move, and within 2 counts
/// over the last 10 s, has settled. Exit code 1 if it doesn't with the plant as stated.
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
        let found = of(bench, &scenario)?;
        outln!("{}", text(&found));
        Ok(if found.settle_time_s.is_some() { Exit::Pass } else { Exit::Fail })
    }
}

/// The margins of a scenario.
pub(super) fn of(bench: &Bench, scenario: &Scenario) -> Result<Margins, CliError> {
    let text = scenario.to_toml().map_err(system("write the scenario as TOML"))?;
    // The text has paths that are relative to the working directory.
    let name = Path::new(&scenario.name).file_name().unwrap_or_default();
    Ok(margins(bench, &name.to_string_lossy(), &text)?)
}

/// The lines on standard output.
pub(super) fn text(found: &Margins) -> String {
    let settled = found.settle_time_s.map_or_else(
        || "simulation           the load doesn't settle, or hunts: there are no margins".to_owned(),
        |it| format!("simulation           settles within 5 % after {it:.2} s"),
    );
    let margins = found.margins.iter().map(|it| format!("margin               {it}"));
    [settled].into_iter().chain(margins).collect::<Vec<_>>().join("\n")
}

/// Prints what the law makes of the estimates, and writes the reach that confirms it into the folder.
pub(super) fn first_reach(scenario: &Scenario, folder: Option<&Path>, bench: &Bench) -> Result<(), CliError> {
    let Reference::Constant { position_rad } = scenario.reference else { return Ok(()) };
    let found = of(bench, scenario)?;
    outln!("\nfirst reach          {position_rad} rad with {}, on the estimated plant", reach::LAW);
    outln!("{}", text(&found));
    let Some((folder, settle_time_s)) = folder.zip(found.settle_time_s) else { return Ok(()) };
    let toml = |scenario: &Scenario| scenario.to_toml().map_err(system("write the scenario as TOML"));
    let resolution_rad = TAU / f64::from(scenario.encoders.load_counts_per_rev);
    let expectations = Override::Set(reach::expectations(settle_time_s, resolution_rad));
    let scenario =
        Scenario::from_str_with(&scenario.name, &toml(scenario)?, &[expectations], &plants(bench))?;
    let file = folder.join(reach::REACH_FILE);
    write_file(&file, &toml(&scenario)?)?;
    outln!("{}", file.display());
    Ok(())
}
