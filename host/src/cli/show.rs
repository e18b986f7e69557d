//! `lashloop show`: a scenario as it is understood.

use std::path::PathBuf;

use clap::Args;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::output::outln;

/// Check a scenario and print it with every default spelled out.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario
    scenario: PathBuf,

    /// Another value for a key, as for `run`
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let overrides: Vec<_> = self.set.into_iter().map(Override::Set).collect();
        let scenario = Scenario::from_file(&self.scenario, &overrides)?;
        let text = scenario.to_toml().map_err(|error| CliError::System {
            what: "spell the scenario as TOML",
            source: std::io::Error::other(error),
        })?;
        outln!("{}", text.trim_end());
        Ok(Exit::Pass)
    }
}
