//! `lashloop budget`: the time of a control cycle on a serial line, and the place of a measured line on a map.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use lashloop::Bench;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::Exit;
use lashloop_campaign::budget::line_map::LineMap;
use lashloop_campaign::budget::{Budget, Cycle};
use lashloop_session::{Session, Subscription};

use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;

use super::budget_on_map::Placing;
use super::error::CliError;
use super::options::{DEFAULT_BAUD, plants};
use super::output::outln;

/// Compute the time budget of a control period on a serial line
///
/// Makes no run: the budget follows from the lengths of the protocol's frames at ten bits per byte, full duplex. Defaults
/// without a scenario: 921600 bit/s, 1000 us, telemetry of the first law's
/// signals with every 10th torque. Exit code 1 if the worst cycle exceeds the
/// period.
///
/// --measured PORT measures the round trip to a disarmed drive instead, and places the line on a map of the delay, jitter and
/// loss that each law tolerates. Exit code 1 if the law of the scenario is outside its limit there; without a scenario, any law.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario with period, telemetry and speed
    scenario: Option<PathBuf>,

    /// Speed of the line, in bit/s, instead of the scenario's
    #[arg(long, value_parser = clap::value_parser!(u32).range(1200..=12_000_000))]
    baud: Option<u32>,

    /// Control period, in us, instead of the scenario's
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(100..=100_000))]
    period_us: Option<u32>,

    /// Torques per telemetry frame, instead of the scenario's; 0 for no telemetry
    #[arg(long, value_name = "STEPS")]
    telemetry_every: Option<u16>,

    /// Number of signals in a telemetry frame, instead of the scenario's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=MOST_SIGNALS as i64))]
    signals: Option<u8>,

    /// Measure the line to this drive, a terminal or any other device of `lashloop run`, and place it on the map
    #[arg(long, value_name = "PORT", conflicts_with_all = ["telemetry_every", "signals"])]
    measured: Option<DeviceChoice>,

    /// Samples of the measurement [default: 1000]
    #[arg(long, value_name = "N", requires = "measured", value_parser = clap::value_parser!(u32).range(20..=1_000_000))]
    rounds: Option<u32>,

    /// Folder of a campaign over line.delay_us, line.jitter_us and line.loss; without --measured the map is printed
    /// [default: the map of campaigns/link-budget.toml in this program]
    #[arg(long, value_name = "DIR", conflicts_with_all = ["telemetry_every", "signals"])]
    map: Option<PathBuf>,
}

/// Most signals in a telemetry frame.
const MOST_SIGNALS: u8 = MAX_TELEMETRY_VALUES as u8;

/// The signals that a run would subscribe to: those that the scenario names, or else all of its law. A law that the drive
/// in process lacks may have as many as fit.
fn signals(bench: &Bench, scenario: Option<&Scenario>) -> u8 {
    if let Some(signals) = scenario.and_then(|scenario| scenario.telemetry.signals.as_ref()) {
        return signals.len() as u8;
    }
    let of_law = || {
        let session = Session::open(bench.in_process(), 1).ok()?;
        let named = |name: &str| session.laws.iter().find(|law| law.name == name);
        let law = scenario.map_or(session.laws.first(), |scenario| named(&scenario.controller.name))?;
        Some(Subscription::to_all(&session.signals, law.index, 1).0.signals().len() as u8)
    };
    of_law().unwrap_or(MOST_SIGNALS)
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let scenario =
            self.scenario.map(|path| Scenario::from_file_with(&path, &[], &plants(bench))).transpose()?;
        let map = || match &self.map {
            Some(folder) => LineMap::read(folder, &plants(bench)),
            None => LineMap::shipped(),
        };
        if let Some(port) = &self.measured {
            let (map, scenario) = (map()?, scenario.as_ref());
            let rounds = self.rounds.unwrap_or(1000);
            let placing =
                Placing { port, baud: self.baud, period_us: self.period_us, rounds, map: &map, scenario };
            return placing.run();
        }
        if self.map.is_some() {
            let mut map = map()?;
            if let Some(scenario) = &scenario {
                let chosen = map.of_law(scenario)?.name.clone();
                map.variants.retain(|variant| variant.name == chosen);
            }
            outln!("{map}");
            return Ok(Exit::Pass);
        }
        let signals = self.signals.unwrap_or_else(|| signals(bench, scenario.as_ref()));
        let defaults = scenario.map_or((DEFAULT_BAUD, 1_000, 10), |scenario| {
            let baud = scenario.link.modelled_baud().unwrap_or(scenario.link.baud);
            (baud, scenario.run.control_period_us, scenario.telemetry.every_steps)
        });
        let budget = Budget {
            baud: self.baud.unwrap_or(defaults.0),
            period: Duration::from_micros(self.period_us.unwrap_or(defaults.1).into()),
            telemetry_every: self.telemetry_every.unwrap_or(defaults.2),
            signals: signals.into(),
        };
        outln!("{budget}");
        Ok(if budget.holds(Cycle::Worst) { Exit::Pass } else { Exit::Fail })
    }
}
