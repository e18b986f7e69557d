//! `lashloop show`: a scenario with every default, or every key that a scenario can have.

use std::path::PathBuf;

use clap::Args;
use lashloop::Bench;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::verdict::Exit;

use super::error::{CliError, system};
use super::options::plants;
use super::output::outln;

/// Check a scenario and print every key with its value, or print all keys there are
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario in TOML: plant, encoders, controller, reference and expectations
    #[arg(required_unless_present_any = ["keys", "schema"])]
    scenario: Option<PathBuf>,

    /// Value instead of the scenario's, such as plant.dead_zone_rad=0.2; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE", requires = "scenario")]
    set: Vec<String>,

    /// Print every key with unit, range, default and meaning, as Markdown
    #[arg(long, conflicts_with_all = ["scenario", "schema"])]
    keys: bool,

    /// Print every key as a JSON Schema for editors
    #[arg(long, conflicts_with = "scenario")]
    schema: bool,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let plants = plants(bench);
        let text = match self.scenario {
            Some(path) => {
                let overrides: Vec<_> = self.set.into_iter().map(Override::Set).collect();
                let scenario = Scenario::from_file_with(&path, &overrides, &plants)?;
                scenario.to_toml().map_err(system("write the scenario as TOML"))?
            }
            None if self.schema => format!("{:#}", Scenario::keys_with(&plants).to_json_schema()),
            None => Scenario::keys_with(&plants).to_markdown(),
        };
        outln!("{}", text.trim_end());
        Ok(Exit::Pass)
    }
}
