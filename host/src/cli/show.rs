//! `lashloop show`: a scenario with every default.

use clap::Args;
use lashloop_bench::verdict::Exit;

use super::error::{CliError, system};
use super::options::ScenarioOptions;
use super::output::outln;

/// Check a scenario and print every key with its value
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioOptions,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let scenario = self.scenario.read(None)?;
        let text = scenario.to_toml().map_err(system("write the scenario as TOML"))?;
        outln!("{}", text.trim_end());
        Ok(Exit::Pass)
    }
}
