//! `lashloop paper`: what serves the study of one paper (Merzouki and Cadiou 2005). A command is a file here.

mod battery;
mod demo;
mod experiment;
mod figures;
mod history;

use clap::{Args, Subcommand};
use lashloop::Bench;
use lashloop_bench::verdict::Exit;

use super::error::CliError;

/// Reproduce the paper behind plant and law: demo, figures, experiment, random plants
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    study: Study,
}

#[derive(Subcommand)]
enum Study {
    Demo(demo::Arguments),
    Figures(figures::Arguments),
    Experiment(experiment::Arguments),
    Battery(battery::Arguments),
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        match self.study {
            Study::Demo(arguments) => arguments.run(bench),
            Study::Figures(arguments) => arguments.run(bench),
            Study::Experiment(arguments) => arguments.run(bench),
            Study::Battery(arguments) => arguments.run(bench),
        }
    }
}
