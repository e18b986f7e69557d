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

mod battery;
mod budget;
mod budget_on_map;
mod campaign;
mod campaign_report;
mod campaign_run;
mod campaign_selection;
mod campaign_submit;
mod check;
mod clock_options;
mod colour;
mod commission;
mod compare;
mod completions;
mod conformance;
mod decode;
mod demo;
mod device;
mod diff;
mod doctor;
mod error;
mod experiment;
mod export;
mod flash;
mod history;
mod identify;
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
mod test_reports;
mod watch_options;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use lashloop_bench::verdict::Exit;

use lashloop::Bench;

registry::commands! {
    "Run a drive on the bench": Run(run), Test(test), Demo(demo), Paper(paper), Experiment(experiment), Device(device), Campaign(campaign), Battery(battery), Soak(soak);
    "Inspect scenarios, records and lines":
        Show(show), Check(check), Plot(plot), Report(report), Export(export), Decode(decode), Parameters(parameters),
        Budget(budget);
    "Find what a change did to a run": Diff(diff), Rerun(rerun), Replay(replay);
    "Qualify a drive, a line or this machine": Conformance(conformance), Doctor(doctor), Compare(compare);
    "Work on a bench with hardware": Flash(flash), Rig(rig), Commission(commission), Identify(identify);
    "Set up a shell": Completions(completions);
}

/// Hardware-in-the-loop bench for drives with gear backlash.
///
/// The bench simulates the mechanics; the controller runs in the drive's firmware. Only bytes pass between them: over a
/// serial port, a pseudo-terminal, or to a Cortex-M image in QEMU. A run ends in a verdict.
#[derive(Parser)]
#[command(name = "lashloop", version, after_help = EXIT_CODES, after_long_help = LONG_HELP, max_term_width = 100)]
struct Lashloop {
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
  lashloop demo                               the paper's four runs, as a table and a figure
  lashloop paper                              the paper's figures and numbers next to ours
  lashloop show scenarios/smooth-after.toml   every key of the scenario with its value
  lashloop run scenarios/smooth-after.toml    one run on the native twin
  lashloop run scenarios/smooth-after.toml --device qemu --out out/qemu
  lashloop test scenarios --jobs 2            every scenario of a folder
  lashloop plot out/qemu                      the record of that run as a figure
  lashloop report out/qemu                    the same as a page for a browser: verdict, margins, plots, timing
  lashloop device                             a drive on a pseudo-terminal; in a second shell:
  lashloop run scenarios/smooth-after.toml --device /dev/pts/N";

/// The command line of a bench: parses the arguments of this process, runs the command and prints its error, if any, as one
/// sentence. The exit code is that of the command.
///
/// The program itself is the native twin (`device`), and the guard of the processes that a run starts: this must be all that
/// the program's own `main` does.
#[must_use]
pub fn main(bench: &Bench) -> ExitCode {
    let command = registry::with_groups(Lashloop::command(), GROUPS);
    let matches = options::with_devices(command, bench).try_get_matches();
    let command = match matches.and_then(|matches| Lashloop::from_arg_matches(&matches)) {
        Ok(Lashloop { command }) => command,
        Err(error) => {
            let _ = error.print();
            return if error.use_stderr() { Exit::UsageOrScenario.into() } else { Exit::Pass.into() };
        }
    };
    match command.run(bench) {
        Ok(exit) => exit.into(),
        Err(error) => {
            output::error_line(format_args!("lashloop: {error}"));
            error.exit().into()
        }
    }
}
