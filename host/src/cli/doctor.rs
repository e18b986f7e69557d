//! `lashloop doctor`: is a terminal fit for a bench?

use std::path::PathBuf;

use clap::Args;
use lashloop::doctor::{self, LineUnderTest};
use lashloop_bench::verdict::Exit;

use super::device_options::BaudOption;
use super::error::CliError;
use super::output::outln;

/// Examine a terminal with a drive: open, greet, measure the round trip, and say what to mend.
///
/// The drive is not armed and gives no torque. Exit code 1 says that there is something to mend, 4 that there is no
/// conversation with a drive.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The terminal, like /dev/ttyACM0 or /dev/pts/3
    terminal: PathBuf,

    #[command(flatten)]
    line: BaudOption,

    /// Samples to measure with
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    rounds: u32,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let line = LineUnderTest { terminal: &self.terminal, baud: self.line.baud, rounds: self.rounds };
        let examination = doctor::examine(&line);
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
