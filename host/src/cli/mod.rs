//! The command line: one file per command.

/// Prints a line on standard output.
macro_rules! say {
    ($($text:tt)*) => {
        $crate::cli::output::line(format_args!($($text)*))
    };
}

mod battery;
mod budget;
mod clock_options;
mod compare;
mod conformance;
mod decode;
mod demo;
mod device;
mod doctor;
mod error;
mod output;
mod paper;
mod parameters;
mod ping_pong;
mod plot;
mod ports;
mod progress;
mod report;
mod run;
mod run_child;
mod show;
mod soak;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;

use error::CliError;

/// Hardware-in-the-loop bench for drives with gear backlash.
///
/// The mechanics are simulated here, the controller runs in the real firmware, and only bytes pass between them: over
/// a serial port, a pseudo-terminal, or to a Cortex-M image in QEMU. A run ends in a verdict.
#[derive(Parser)]
#[command(version, after_help = EXIT_CODES, after_long_help = LONG_HELP, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Run(run::Arguments),
    Demo(demo::Arguments),
    Paper(paper::Arguments),
    Plot(plot::Arguments),
    Device(device::Arguments),
    Show(show::Arguments),
    Decode(decode::Arguments),
    Ports(ports::Arguments),
    Doctor(doctor::Arguments),
    Budget(budget::Arguments),
    Battery(battery::Arguments),
    Compare(compare::Arguments),
    Soak(soak::Arguments),
    Conformance(conformance::Arguments),
    Parameters(parameters::Arguments),
    #[command(hide = true)]
    Tied(run_child::Arguments),
    #[command(hide = true)]
    PingPong,
}

const EXIT_CODES: &str = "\
Exit codes: 0 PASS, 1 FAIL, 2 bad usage, scenario or output folder, 3 INVALID, 4 device or link.";

const LONG_HELP: &str = "\
Exit codes:
  0  PASS     every expectation of the scenario is met
  1  FAIL     an expectation or a limit is not met, the drive latched a fault, it breaks a rule of the protocol, or
              a line is too slow
  2           bad usage, a bad scenario, or an output folder that can't be written
  3  INVALID  link or timing broke what the scenario allows, or the run was interrupted
  4           the device or the link failed; there is no verdict

First steps:
  lashloop demo                                        the paper's four runs and a picture
  lashloop paper                                       the paper's figures and numbers, paper and here
  lashloop run scenarios/smooth-after.toml             one run, with the native twin
  lashloop show scenarios/smooth-after.toml            every key a scenario can have
  lashloop run scenarios/smooth-after.toml --device qemu --out out/qemu
  lashloop plot out/qemu                               what it did, as a picture
  lashloop device                                      a drive on a terminal, for a second shell:
  lashloop run scenarios/smooth-after.toml --device /dev/pts/N";

/// Parses, runs, and says in one sentence what went wrong.
pub(crate) fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print();
            return if error.use_stderr() { Exit::UsageOrScenario.into() } else { Exit::Pass.into() };
        }
    };
    let result = match arguments.command {
        Command::Run(arguments) => arguments.run(),
        Command::Demo(arguments) => arguments.run(),
        Command::Paper(arguments) => arguments.run(),
        Command::Plot(arguments) => arguments.run(),
        Command::Device(arguments) => arguments.run(),
        Command::Show(arguments) => arguments.run(),
        Command::Decode(arguments) => arguments.run(),
        Command::Ports(arguments) => arguments.run(),
        Command::Doctor(arguments) => arguments.run(),
        Command::Budget(arguments) => arguments.run(),
        Command::Battery(arguments) => arguments.run(),
        Command::Compare(arguments) => arguments.run(),
        Command::Soak(arguments) => arguments.run(),
        Command::Conformance(arguments) => arguments.run(),
        Command::Parameters(arguments) => arguments.run(),
        Command::Tied(arguments) => arguments.run(),
        Command::PingPong => ping_pong::answer(),
    };
    match result {
        Ok(exit) => exit.into(),
        Err(error) => {
            output::error_line(format_args!("lashloop: {error}"));
            error.exit().into()
        }
    }
}

/// Bits a second on a serial port, where no scenario says it.
const DEFAULT_BAUD: u32 = 921_600;

fn start_supervisor() -> Result<Supervisor, CliError> {
    std::env::current_exe()
        .and_then(Supervisor::start)
        .map_err(|source| CliError::System { what: "start the supervisor", source })
}
