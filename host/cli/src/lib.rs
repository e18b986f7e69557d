//! The command line. A command is a file of its own with `Arguments` and `Arguments::run`, and its two lines here: the
//! module, and its place in the groups of the help.
//!
//! [`main`] is the whole `main` of a program, that of `lashloop` and that of a program of your own:
//!
//! ```no_run
//! fn main() -> std::process::ExitCode {
//!     lashloop_cli::main(&lashloop::Bench::new())
//! }
//! ```

#![forbid(unsafe_code)]

mod benchmark;
mod bode;
mod bode_table;
mod budget;
mod budget_on_map;
mod campaign;
mod campaign_report;
mod campaign_run;
mod campaign_selection;
mod campaign_submit;
mod clock_options;
mod colour;
mod commission;
mod commission_motor;
mod completions;
mod conformance;
mod decode;
mod device;
mod diff;
mod doctor;
mod encoder_errors;
mod error;
mod export;
mod first_reach;
mod flash;
mod fmu;
mod identify;
mod interruptible;
mod margins;
mod monitor;
mod one_run;
mod options;
mod output;
mod paper;
mod parameters;
mod ping_pong;
mod plot;
mod png;
mod progress;
mod registry;
mod replay;
mod report;
mod report_files;
mod rerun;
mod rig;
mod run;
mod run_child;
mod run_junit;
mod run_report;
mod show;
mod soak;
mod supervision;
mod test;
mod watch_options;

use std::process::ExitCode;
use std::{env, io};

use clap::{ArgAction, CommandFactory, FromArgMatches, Parser, Subcommand};
use lashloop_bench::device::Build;
use lashloop_bench::supervisor::{end_at_signals, is_interrupted};
use lashloop_bench::verdict::Exit;

use lashloop::Bench;
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::time::uptime;

registry::commands! {
    "Run a drive on the bench": Run(run), Test(test), Campaign(campaign), Soak(soak), Device(device), Paper(paper);
    "Inspect scenarios, records and lines":
        Show(show), Plot(plot), Report(report), Export(export), Decode(decode), Parameters(parameters), Budget(budget), Fmu(fmu);
    "Find what a change did to a run": Diff(diff), Rerun(rerun), Replay(replay);
    "Qualify a drive, a line or this machine": Margins(margins), Bode(bode), Conformance(conformance), Doctor(doctor), Benchmark(benchmark);
    "Work on a bench with hardware": Flash(flash), Rig(rig), Commission(commission), Identify(identify);
    "Set up a shell": Completions(completions);
}

/// Hardware-in-the-loop bench for drives with gear backlash.
///
/// The bench simulates the mechanics; the controller runs in the drive's firmware. Only bytes pass between them: over a
/// serial port, a pseudo-terminal, or to a Cortex-M image in QEMU. A run ends in a verdict.
#[derive(Parser)]
#[command(after_help = EXIT_CODES, max_term_width = 100)]
struct Lashloop {
    /// Print events on standard error; -vv more of them
    ///
    /// Handshakes, programs that start and end, files; with -vv retries, threads and open lines. RUST_LOG, if it is set,
    /// chooses instead.
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,

    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "\
Exit codes: 0 PASS, 1 FAIL, 2 bad usage, scenario or output folder, 3 INVALID, 4 device or link, 5 hardware absent.";

const LONG_HELP: &str = "\
Exit codes:
  0  PASS     every expectation of the scenario is met
  1  FAIL     an expectation, a limit or a rule of the protocol is missed, or the drive latched a fault
  2           bad usage, a bad scenario, or an output folder that can't be written
  3  INVALID  link or timing exceeded what the scenario allows, or the run was interrupted
  4           the device or the link failed; there is no verdict
  5           the hardware of a rig is absent; nothing was run, there is no verdict

First steps:
  lashloop paper demo                         the paper's plants under three laws, as a table and a figure
  lashloop paper figures                      the paper's figures and numbers next to ours
  lashloop show scenarios/smooth-after.toml   every key of the scenario with its value
  lashloop run scenarios/smooth-after.toml    one run on the native twin
  lashloop run scenarios/smooth-after.toml --device qemu --out out/qemu
  lashloop test scenarios --jobs 2            every scenario of a folder
  lashloop plot out/qemu                      the record of that run as a figure
  lashloop report out/qemu                    the same as a page for a browser: verdict, margins, plots, timing
  lashloop device                             a drive on a pseudo-terminal; in a second shell:
  lashloop run scenarios/smooth-after.toml --device /dev/pts/N";

/// The commands as a program of this name has them.
fn command_line(name: &str) -> clap::Command {
    registry::with_groups(Lashloop::command(), GROUPS)
        .after_long_help(LONG_HELP.replace("  lashloop ", &format!("  {name} ")))
        .version(format!("{} ({})", env!("CARGO_PKG_VERSION"), Build::OF_BENCH))
        .name(name.to_owned())
}

/// The command line of a bench: parses the arguments of this process, runs the command and prints its error, if any, as one
/// sentence. The exit code is that of the command.
///
/// The program itself is the native twin (`device`), and the guard of the processes that a run starts: this must be all that
/// the program's own `main` does.
#[must_use]
pub fn main(bench: &Bench) -> ExitCode {
    let command = command_line(&output::program_name());
    let matches = options::with_devices(command, bench).try_get_matches();
    let command = match matches.and_then(|matches| Lashloop::from_arg_matches(&matches)) {
        Ok(Lashloop { verbose, command }) => {
            log_to_standard_error(verbose);
            // A twin and the far end of a ping-pong serve until they are killed, and a guard outlives its bench.
            let serves = matches!(command, Command::Device(_) | Command::Tied(_) | Command::PingPong);
            if !serves && let Err(error) = end_at_signals() {
                output::warn(format_args!("signals end the program without its exit code: {error}"));
            }
            command
        }
        Err(error) => {
            if error.print().is_err() && !error.use_stderr() {
                return Exit::UsageOrScenario.into();
            }
            return if error.use_stderr() { Exit::UsageOrScenario.into() } else { Exit::Pass.into() };
        }
    };
    match command.run(bench) {
        Ok(exit) => exit.into(),
        Err(error) => {
            output::complain(format_args!("{error}"));
            // An interruption may be the cause, so the error shows nothing about drive or link.
            if is_interrupted() && error.exit() != Exit::Invalid {
                output::complain(format_args!("INVALID: interrupted by the user"));
                return Exit::Invalid.into();
            }
            error.exit().into()
        }
    }
}

/// Prints the events of the libraries, for a person at a line that does not work.
pub(crate) fn log_to_standard_error(verbose: u8) {
    let chosen = env::var("RUST_LOG").unwrap_or_default();
    let level = match verbose {
        0 if chosen.is_empty() => return,
        0 | 1 => "info",
        2 => "debug",
        _ => "trace",
    };
    let filter = if chosen.is_empty() { level } else { &chosen };
    let filter = EnvFilter::try_new(filter).unwrap_or_else(|error| {
        output::warn(format_args!("RUST_LOG is {chosen:?}, {error}; it has no effect"));
        EnvFilter::new(if verbose == 0 { "off" } else { level })
    });
    let events = tracing_subscriber::fmt().with_env_filter(filter).with_writer(io::stderr);
    // A second call changes nothing.
    let _ = events.with_timer(uptime()).with_target(false).log_internal_errors(false).try_init();
}
