//! `lashloop conformance`: whether a drive conforms to the protocol.

use std::fs;
use std::path::PathBuf;

use crate::bench::Bench;
use crate::conformance::{self, CheckResult, CheckStatus, Reporter, junit};
use clap::Args;
use lashloop_bench::device::{Connection, session_number};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;
use lashloop_protocol::message::Identity;

use super::error::{CliError, system};
use super::options::{BaudOption, DeviceOption};
use super::output::outln;
use super::supervision::start_supervisor;

/// Check a drive against the protocol, rule by rule
///
/// Resets the drive before every check and at the end, so its parameters return to their defaults. Run it without
/// mechanics: some checks produce torque. Exit code 1 if the drive breaks a rule, 3 if interrupted, 4 if the drive or the
/// line fails.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    drive: DeviceOption,

    #[command(flatten)]
    line: BaudOption,

    /// File for the results as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let supervisor = start_supervisor()?;
        let (link, connection) = Connection::open(&self.drive.device, self.line.baud, &supervisor)?;
        let mut printer = Printer {
            connection: &connection,
            device: self.drive.device.to_string(),
            results: Vec::new(),
            supervisor: &supervisor,
        };
        let signals = supervisor.guard_signals();
        let ended = conformance::run(link, session_number(), &mut printer);
        drop(signals);
        let Printer { device, results, .. } = printer;
        if let Some(path) = &self.junit {
            let xml = junit::report(&device, &results).map_err(system("write the results as XML"))?;
            fs::write(path, xml).map_err(|source| CliError::Report { path: path.clone(), source })?;
        }
        ended.map_err(|source| connection.explain(source))?;
        let [passed, failed, skipped] = counts(&results);
        outln!("{passed} passed, {failed} failed, {skipped} skipped");
        Ok(match failed {
            _ if supervisor.interrupted() => Exit::Invalid,
            0 => Exit::Pass,
            _ => Exit::Fail,
        })
    }
}

/// Numbers of checks passed, failed and skipped.
fn counts(results: &[CheckResult]) -> [usize; 3] {
    results.iter().fold([0; 3], |[passed, failed, skipped], result| match result.status {
        CheckStatus::Passed => [passed + 1, failed, skipped],
        CheckStatus::Failed { .. } => [passed, failed + 1, skipped],
        CheckStatus::Skipped { .. } => [passed, failed, skipped + 1],
    })
}

struct Printer<'a> {
    connection: &'a Connection,
    /// Description of the drive under test.
    device: String,
    results: Vec<CheckResult>,
    supervisor: &'a Supervisor,
}

impl Reporter for Printer<'_> {
    fn connected(&mut self, identity: &Identity) {
        self.device = self.connection.description(identity);
        outln!("{}", self.device);
    }

    fn checked(&mut self, result: &CheckResult) {
        let CheckResult { group, name, status, note, .. } = result;
        let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
        match status {
            CheckStatus::Passed => outln!("PASS     {group}: {name}{note}"),
            CheckStatus::Failed { expected, got } => {
                outln!("FAIL     {group}: {name}{note}; expected {expected}, got {got}");
            }
            CheckStatus::Skipped { reason } => outln!("SKIPPED  {group}: {name}; {reason}"),
        }
        self.results.push(result.clone());
    }

    fn is_interrupted(&self) -> bool {
        self.supervisor.interrupted()
    }
}
