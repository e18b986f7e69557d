//! `lashloop fmu`: what an FMU is and has. The program `lashloop-fmu` reads it, as it does in a run.

use std::path::PathBuf;
use std::process;

use clap::{Args, Subcommand};
use lashloop::Bench;
use lashloop_bench::process_plant;
use lashloop_bench::verdict::Exit;

use super::error::{CliError, system};

/// Inspect an FMU, the plant of `plant.model = "fmu"`
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Print version, kinds, platforms, steps and variables with units, and a [plant] section for the FMU
    Show {
        /// FMU of FMI 1.0, 2.0 or 3.0
        file: PathBuf,
    },
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let Command::Show { file } = self.command;
        let loader = process_plant::loader()?;
        let status = process::Command::new(loader).arg("show").arg(file).status();
        // It has printed its error.
        let shown = status.map_err(system("start lashloop-fmu"))?.success();
        Ok(if shown { Exit::Pass } else { Exit::UsageOrScenario })
    }
}
