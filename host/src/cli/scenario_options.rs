//! Options that name a scenario.

use std::path::PathBuf;

use clap::Args;
use lashloop_bench::scenario::{Override, Scenario};

use super::error::CliError;

#[derive(Args)]
pub(super) struct ScenarioOptions {
    /// Scenario in TOML: plant, encoders, controller, reference and expectations
    scenario: PathBuf,

    /// Value in place of the scenario's, such as plant.dead_zone_rad=0.2; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,
}

impl ScenarioOptions {
    /// `more` applies after the settings.
    pub(super) fn read(self, more: Option<Override>) -> Result<Scenario, CliError> {
        let overrides: Vec<_> = self.set.into_iter().map(Override::Set).chain(more).collect();
        Ok(Scenario::from_file(&self.scenario, &overrides)?)
    }
}
