//! `lashloop budget`: what a line leaves of a control period.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use lashloop::budget::{Budget, Cycle, Report};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::Exit;

use super::device_options::DEFAULT_BAUD;
use super::error::CliError;
use super::output::outln;

/// Work out what a serial line leaves of a control period, and how fast a loop over it can be.
///
/// Nothing is run: the bytes are those of the protocol's frames, ten bits each, both directions at once. Without a
/// scenario it is 1 kHz with telemetry after every tenth torque. Ends with 1 if the period does not hold the worst cycle.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario that says period, telemetry and speed
    scenario: Option<PathBuf>,

    /// Another speed of the line, in bits a second
    #[arg(long, value_parser = clap::value_parser!(u32).range(1200..=12_000_000))]
    baud: Option<u32>,

    /// Another control period
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(100..=100_000))]
    period_us: Option<u32>,

    /// Telemetry after every so many torques; 0 for none
    #[arg(long, value_name = "STEPS")]
    telemetry_every: Option<u16>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let scenario = self.scenario.map(|path| Scenario::from_file(&path, &[])).transpose()?;
        let said = scenario.map_or((DEFAULT_BAUD, 1_000, 10), |scenario| {
            let baud = scenario.link.modelled_baud().unwrap_or(scenario.link.baud);
            (baud, scenario.run.control_period_us, scenario.telemetry.every_steps)
        });
        let budget = Budget {
            baud: self.baud.unwrap_or(said.0),
            period: Duration::from_micros(self.period_us.unwrap_or(said.1).into()),
            telemetry_every: self.telemetry_every.unwrap_or(said.2),
        };
        outln!("{}", Report(budget));
        Ok(if budget.holds(Cycle::Worst) { Exit::Pass } else { Exit::Fail })
    }
}
