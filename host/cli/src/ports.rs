//! `lashloop ports`: the serial ports of this machine.

use clap::Args;
use lashloop::Bench;
use lashloop_bench::verdict::Exit;
use lashloop_hardware::ports;

use super::error::{CliError, system};
use super::output::outln;

/// List the serial ports with their USB identity and stable names
#[derive(Args)]
pub(crate) struct Arguments {}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let ports = ports::list().map_err(system("list serial ports"))?;
        outln!("{}", ports::describe(&ports));
        Ok(Exit::Pass)
    }
}
