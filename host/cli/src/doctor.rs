//! `lashloop doctor`: the serial ports of this machine, and whether a line is fit for a bench.

use clap::Args;
use lashloop::Bench;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::verdict::Exit;
use lashloop_hardware::doctor::finding::Finding;
use lashloop_hardware::{doctor, ports};

use super::error::{CliError, system};
use super::options::BaudOption;
use super::output::{outln, print_json};
use super::supervision::start_supervisor;

/// List the serial ports, or diagnose the line to a drive: open, handshake, round trip
///
/// Without an argument it lists the serial ports with their USB identity and stable names. The drive stays disarmed and
/// produces no torque. Exit code 1 if a property needs a remedy, 4 if no drive completes the handshake.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Drive: the path of a terminal such as /dev/ttyACM0 or /dev/pts/3, or any other device of `lashloop run`
    #[arg(value_name = "DEVICE")]
    device: Option<DeviceChoice>,

    #[command(flatten)]
    line: BaudOption,

    /// Samples of the round-trip measurement
    #[arg(long, default_value_t = 1000, requires = "device", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    rounds: u32,

    /// Print the findings as a JSON array
    #[arg(long, requires = "device")]
    json: bool,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let Some(device) = self.device else {
            outln!("{}", ports::describe(&ports::list().map_err(system("list serial ports"))?));
            return Ok(Exit::Pass);
        };
        let supervisor = start_supervisor()?;
        let print = |finding: &Finding| {
            if !self.json {
                outln!("{finding}");
            }
        };
        let examination = doctor::examine(&device, self.line.baud, self.rounds, &supervisor, print);
        if self.json {
            print_json(&examination.findings)?;
        }
        Ok(match (examination.reached, examination.is_healthy()) {
            (false, _) => Exit::DeviceOrLink,
            (true, false) => Exit::Fail,
            (true, true) => Exit::Pass,
        })
    }
}
