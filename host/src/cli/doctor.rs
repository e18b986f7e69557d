//! `lashloop doctor`: whether a terminal is fit for a bench.

use std::path::PathBuf;

use crate::bench::Bench;
use crate::doctor;
use clap::Args;
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::options::BaudOption;
use super::output::outln;

/// Diagnose a terminal with a drive: open, handshake, round trip
///
/// The drive stays disarmed and produces no torque. Exit code 1 if a property needs a remedy, 4 if no drive completes the
/// handshake.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Terminal, such as /dev/ttyACM0 or /dev/pts/3
    terminal: PathBuf,

    #[command(flatten)]
    line: BaudOption,

    /// Samples of the round-trip measurement
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    rounds: u32,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let examination = doctor::examine(&self.terminal, self.line.baud, self.rounds);
        for diagnosis in &examination.diagnoses {
            outln!("{diagnosis}");
        }
        Ok(match (examination.reached, examination.is_healthy()) {
            (false, _) => Exit::DeviceOrLink,
            (true, false) => Exit::Fail,
            (true, true) => Exit::Pass,
        })
    }
}
