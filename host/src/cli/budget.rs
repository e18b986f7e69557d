//! `lashloop budget`: the time of a control cycle on a serial line.

use std::path::PathBuf;
use std::time::Duration;

use crate::bench::Bench;
use crate::budget::{Budget, Cycle};
use clap::Args;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::options::{DEFAULT_BAUD, plants};
use super::output::outln;

/// Compute the time budget of a control period on a serial line
///
/// Makes no run: the budget follows from the lengths of the protocol's frames at ten bits per byte, full duplex. Defaults
/// without a scenario: 921600 bit/s, 1000 us, telemetry with every 10th torque. Exit code 1 if the worst cycle exceeds the
/// period.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario with period, telemetry and speed
    scenario: Option<PathBuf>,

    /// Speed of the line, in bit/s, in place of the scenario's
    #[arg(long, value_parser = clap::value_parser!(u32).range(1200..=12_000_000))]
    baud: Option<u32>,

    /// Control period, in us, in place of the scenario's
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(100..=100_000))]
    period_us: Option<u32>,

    /// Torques per telemetry frame, in place of the scenario's; 0 for no telemetry
    #[arg(long, value_name = "STEPS")]
    telemetry_every: Option<u16>,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let scenario =
            self.scenario.map(|path| Scenario::from_file_with(&path, &[], &plants(bench))).transpose()?;
        let defaults = scenario.map_or((DEFAULT_BAUD, 1_000, 10), |scenario| {
            let baud = scenario.link.modelled_baud().unwrap_or(scenario.link.baud);
            (baud, scenario.run.control_period_us, scenario.telemetry.every_steps)
        });
        let budget = Budget {
            baud: self.baud.unwrap_or(defaults.0),
            period: Duration::from_micros(self.period_us.unwrap_or(defaults.1).into()),
            telemetry_every: self.telemetry_every.unwrap_or(defaults.2),
        };
        outln!("{budget}");
        Ok(if budget.holds(Cycle::Worst) { Exit::Pass } else { Exit::Fail })
    }
}
