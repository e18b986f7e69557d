//! `lashloop rig`: checks of a rig, and the keys of rig files.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::output::{outln, print_json};
use super::supervision::start_supervisor;
use lashloop::Bench;
use lashloop::rig::{Rig, TakenRig};
use lashloop_hardware::rig_check::{Reached, check};

/// Check a bench with hardware, described by a rig file
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Find out everything about a rig that needs no motion: lock, port, line, drive, board, pins, limits, loader
    ///
    /// The drive stays disarmed and produces no torque. Exit code 1 if a finding needs a remedy, 4 if no drive completes the
    /// handshake or another program uses the rig, 5 if the port of the rig doesn't exist.
    Check {
        /// Rig file in TOML
        #[arg(value_name = "RIG")]
        rig: PathBuf,

        /// Print the findings as a JSON array
        #[arg(long)]
        json: bool,
    },
    /// Print every key of a rig file with unit, range, default and meaning, as Markdown
    Keys {
        /// As a JSON Schema for editors
        #[arg(long)]
        schema: bool,
    },
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        match self.verb {
            Verb::Check { rig, json } => check_rig(&rig, bench, json),
            Verb::Keys { schema } => {
                let page = || Rig::page().trim_end().to_owned();
                outln!("{}", if schema { format!("{:#}", Rig::json_schema()) } else { page() });
                Ok(Exit::Pass)
            }
        }
    }
}

fn check_rig(file: &std::path::Path, bench: &Bench, as_json: bool) -> Result<Exit, CliError> {
    let taken = TakenRig::take(file, &bench.devices(), "rig check")?;
    let supervisor = start_supervisor()?;
    let checked = check(&taken.rig, &supervisor);
    if as_json {
        print_json(&checked.findings)?;
    } else {
        for finding in &checked.findings {
            outln!("{finding}");
        }
    }
    let is_wrong = checked.findings.iter().any(lashloop_hardware::doctor::finding::Finding::is_wrong);
    Ok(match checked.reached {
        Reached::NoHardware => Exit::HardwareAbsent,
        Reached::Port => Exit::DeviceOrLink,
        Reached::Drive if is_wrong => Exit::Fail,
        Reached::Drive => Exit::Pass,
    })
}
