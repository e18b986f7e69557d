//! `lashloop show`: a scenario with every default.

use std::path::PathBuf;

use clap::Args;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::output::outln;

/// Check a scenario and print every key with its value
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario in TOML
    scenario: PathBuf,

    /// Value in place of the scenario's, such as plant.dead_zone_rad=0.2; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let overrides: Vec<_> = self.set.into_iter().map(Override::Set).collect();
        let scenario = Scenario::from_file(&self.scenario, &overrides)?;
        let text = scenario.to_toml().map_err(|error| CliError::System {
            what: "write the scenario as TOML",
            source: std::io::Error::other(error),
        })?;
        outln!("{}", text.trim_end());
        Ok(Exit::Pass)
    }
}
