//! `lashloop conformance`: whether a drive keeps to the protocol.

use std::fs;
use std::path::PathBuf;

use clap::Args;
use lashloop::conformance::{self, Finding, Outcome, Watcher, junit};
use lashloop_bench::device::{Connection, DeviceChoice, session_number};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Exit;
use lashloop_protocol::message::Identity;

use super::error::CliError;
use super::{DEFAULT_BAUD, start_supervisor};

/// Check whether a drive keeps to the protocol, rule by rule.
///
/// The drive is reset before every check and at the end: what was set in it is gone. Nothing may be attached to it that
/// a torque can move. Ends with 0 if every rule is kept, 1 if one is broken, 3 if interrupted, 4 if the drive or the line
/// fails.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The drive, as for `run`
    #[arg(long, default_value = "native", value_name = "DEVICE")]
    device: DeviceChoice,

    /// Bits a second, for a serial port
    #[arg(long, default_value_t = DEFAULT_BAUD, value_parser = clap::value_parser!(u32).range(1200..=12_000_000))]
    baud: u32,

    /// Write the findings as JUnit XML into this file, too
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let supervisor = start_supervisor()?;
        let (link, connection) = Connection::open(&self.device, self.baud, &supervisor)?;
        let mut printer = Printer {
            connection: &connection,
            device: self.device.to_string(),
            findings: Vec::new(),
            supervisor: &supervisor,
        };
        let heed = supervisor.guard_signals();
        let ended = conformance::run(link, session_number(), &mut printer);
        drop(heed);
        let Printer { device, findings, .. } = printer;
        let (passed, failed, left_out) = counts(&findings);
        if let Some(path) = &self.junit {
            let xml = junit::report(&device, &findings).map_err(|error| CliError::System {
                what: "write the findings as XML",
                source: std::io::Error::other(error),
            })?;
            fs::write(path, xml).map_err(|source| CliError::Report { path: path.clone(), source })?;
        }
        ended.map_err(|source| connection.explain(source))?;
        say!("{passed} passed, {failed} failed, {left_out} left out");
        Ok(match failed {
            _ if supervisor.interrupted() => Exit::Invalid,
            0 => Exit::Pass,
            _ => Exit::Fail,
        })
    }
}

fn counts(findings: &[Finding]) -> (usize, usize, usize) {
    let count = |wanted: fn(&Outcome) -> bool| findings.iter().filter(|it| wanted(&it.outcome)).count();
    (
        count(|outcome| matches!(outcome, Outcome::Passed)),
        count(|outcome| matches!(outcome, Outcome::Failed { .. })),
        count(|outcome| matches!(outcome, Outcome::LeftOut { .. })),
    )
}

struct Printer<'a> {
    connection: &'a Connection,
    /// Who is tested, in words.
    device: String,
    findings: Vec<Finding>,
    supervisor: &'a Supervisor,
}

impl Watcher for Printer<'_> {
    fn greeted(&mut self, identity: &Identity) {
        self.device = self.connection.description(identity);
        say!("{}", self.device);
    }

    fn found(&mut self, finding: &Finding) {
        let Finding { group, name, outcome, note, .. } = finding;
        let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
        match outcome {
            Outcome::Passed => say!("PASS      {group}: {name}{note}"),
            Outcome::Failed { expected, came } => {
                say!("FAIL      {group}: {name}{note}; expected {expected}, got {came}");
            }
            Outcome::LeftOut { reason } => say!("LEFT OUT  {group}: {name}; {reason}"),
        }
        self.findings.push(finding.clone());
    }

    fn stop_asked(&self) -> bool {
        self.supervisor.interrupted()
    }
}
