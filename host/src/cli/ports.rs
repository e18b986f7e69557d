//! `lashloop ports`: where a board may be.

use clap::Args;
use lashloop::ports;
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::output::outln;

/// List the serial ports, with what USB says of them and names that stay.
#[derive(Args)]
pub(crate) struct Arguments {}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let ports = ports::list().map_err(|source| CliError::System { what: "list serial ports", source })?;
        outln!("{}", ports::describe(&ports));
        Ok(Exit::Pass)
    }
}
