//! `lashloop conformance`: whether a drive conforms to the protocol.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, value_parser};
use lashloop::Bench;
use lashloop_bench::device::{Connection, DeviceChoice, DeviceError, session_number};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::{SignalGuard, Supervisor};
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::Exit;
use lashloop_conformance::unchecked::{UNCHECKED, Unchecked};
use lashloop_conformance::{
    self as conformance, CheckResult, CheckStatus, Listed, PowerStage, Reporter, SILENT_CHECKS, TIME_LIMIT,
};
use lashloop_protocol::message::Identity;
use lashloop_report::junit::{Case, Kind};

use super::error::CliError;
use super::interruptible::Interruptible;
use super::options::{BaudOption, DeviceOption, plants};
use super::output::{complain, error_line, outln, print_json};
use super::report_files;
use super::supervision::start_supervisor;

/// Check a drive against the protocol, rule by rule
///
/// Resets the drive before every check and at the end, so its parameters return to their defaults. Run it without
/// mechanics: some checks produce torque. Repeats less on a slow line: 10 times, 5 from 1.5 ms for an
/// exchange, once from 2.5 ms. Exit code 1 if the drive breaks a rule or its program ends by itself, 3 if interrupted, 4 if the
/// drive or the line fails or if rules were left untested for lack of time.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    drive: DeviceOption,

    /// Print all checks with the rules they test, and the rules without a check; needs no drive
    #[arg(long)]
    list: bool,

    /// Let a drive with bench mode run on its own encoders too: its power stage comes on
    #[arg(long)]
    bench_mode: bool,

    /// Scenario of bench mode whose plant moves the encoders of a drive without hardware, as on virtual silicon
    #[arg(long, value_name = "SCENARIO", requires = "bench_mode")]
    plant: Option<PathBuf>,

    /// Torque in N m for a duty of 1, so that the mechanics move; without it, next to no torque, or that of --plant
    #[arg(long, value_name = "NM", requires = "bench_mode")]
    torque_per_duty_nm: Option<f32>,

    /// Time in s for all checks, a twelfth of it for each attempt at one: more for an emulated drive
    #[arg(long, value_name = "S", default_value_t = TIME_LIMIT.as_secs(), value_parser = value_parser!(u64).range(12..=3600))]
    time_limit_s: u64,

    #[command(flatten)]
    line: BaudOption,

    /// Print the results as a JSON array instead
    #[arg(long, conflicts_with = "list")]
    json: bool,

    /// File for the results as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        if self.list {
            print_list();
            return Ok(Exit::Pass);
        }
        let (device, scale_nm) = match &self.plant {
            None => (self.drive.device.clone(), None),
            Some(path) => with_plant(&self.drive.device, path, bench)?,
        };
        let torque_per_duty_nm = self.torque_per_duty_nm.or(scale_nm);
        let supervisor = start_supervisor()?;
        let (link, connection) = Connection::open(&device, self.line.baud, &supervisor)?;
        let mut printer = Printer {
            connection: &connection,
            device: self.drive.device.to_string(),
            results: Vec::new(),
            supervisor: &supervisor,
            is_silent: self.json,
            bench_mode: self.bench_mode.then_some(PowerStage { torque_per_duty_nm }),
            time_limit: Duration::from_secs(self.time_limit_s),
            signals: None,
        };
        let ended = conformance::run(Box::new(Interruptible(link)), session_number(), &mut printer);
        drop(printer.signals.take());
        let ended = match ended.map_err(|source| connection.explain(source)) {
            Err(error) if error.has_crashed() && !supervisor.interrupted() => {
                printer.checked(&crashed(&error));
                Ok(())
            }
            ended => ended,
        };
        let Printer { device, results, .. } = printer;
        if let Some(path) = &self.junit {
            let interrupted = supervisor.interrupted().then(|| "interrupted".to_owned());
            let ended_by = interrupted.or(ended.as_ref().err().map(ToString::to_string));
            let early = ended_by.map(|cause| Case {
                reasons: vec![format!("the run ended early: {cause}")],
                properties: vec![("device", device.clone())],
                ..Case::new("run", "conformance.run", "the run reaches its last check", Kind::Error)
            });
            let cases = results.iter().map(|result| junit_case(&device, result)).chain(early);
            report_files::write_junit(path, "lashloop conformance", &cases.collect::<Vec<_>>(), None)?;
        }
        if self.json {
            print_json(&results)?;
        }
        let Counts { passed, failed, not_judged, skipped } = Counts::of(&results);
        if let Err(error) = ended
            && !supervisor.interrupted()
        {
            // The drive has broken a rule, whatever ended the line later. Its silence then fails the last checks.
            let before = &results[..results.len().saturating_sub(SILENT_CHECKS as usize)];
            if Counts::of(before).failed == 0 {
                return Err(error.into());
            }
            complain(format_args!("{error}"));
        }
        let had_run = |it: &CheckResult| it.group == "bench_mode" && it.status == CheckStatus::Passed;
        if torque_per_duty_nm.is_none() && results.iter().any(had_run) {
            complain(format_args!("next to no torque; simulated mechanics need --torque-per-duty-nm"));
        }
        if !self.json {
            let interrupted =
                if supervisor.interrupted() { "; interrupted, the rest was not run" } else { "" };
            outln!(
                "{passed} passed, {failed} failed, {not_judged} not judged, {skipped} skipped{interrupted}"
            );
        }
        Ok(match (failed, not_judged) {
            // A rule is broken even if the rest was not run.
            (1.., _) => Exit::Fail,
            _ if supervisor.interrupted() => {
                error_line(format_args!("INVALID: interrupted by the user; the rest was not run"));
                Exit::Invalid
            }
            (0, 0) => Exit::Pass,
            (0, _) => Exit::DeviceOrLink,
        })
    }
}

/// The drive with the plant of this scenario behind its pins, and the scale of its amplifier.
fn with_plant(
    device: &DeviceChoice,
    path: &Path,
    bench: &Bench,
) -> Result<(DeviceChoice, Option<f32>), CliError> {
    let scenario = Scenario::from_file_with(path, &[], &plants(bench))?;
    if scenario.run.mode.is_hil() {
        return Err(CliError::NoPlantAtPins { path: path.to_owned() });
    }
    let torque_per_duty_nm = scenario.bench.torque_per_duty_nm().map(|scale_nm| scale_nm as f32);
    Ok((device.for_run(&scenario, ClockName::RealTime)?, torque_per_duty_nm))
}

/// The result for a drive whose program has ended.
fn crashed(error: &DeviceError) -> CheckResult {
    let (expected, got) = ("a program that ends with its input".to_owned(), error.to_string());
    CheckResult {
        group: "run",
        rules: "",
        name: "the drive runs to the last check".to_owned(),
        status: CheckStatus::Failed { expected, got },
        note: String::new(),
        took: Duration::ZERO,
    }
}

/// A check that was not judged is an error.
fn junit_case(device: &str, result: &CheckResult) -> Case {
    let CheckResult { group, rules, name, status, note, took } = result;
    let (kind, reason) = match status {
        CheckStatus::Passed => (Kind::Success, None),
        CheckStatus::Failed { expected, got } => {
            (Kind::Failure, Some(format!("expected {expected}, got {got}")))
        }
        CheckStatus::NotJudged { cause } => (Kind::Error, Some(format!("not judged: {cause}"))),
        CheckStatus::Skipped { reason } => (Kind::Skipped, Some((*reason).to_owned())),
    };
    Case {
        reasons: reason.into_iter().collect(),
        took: *took,
        properties: vec![("device", device.to_owned()), ("rules", (*rules).to_owned())],
        output: note.clone(),
        ..Case::new(group, &format!("conformance.{group}"), name, kind)
    }
}

fn print_list() {
    for Listed { group, rules, name } in conformance::list() {
        outln!("{rules:<16}  {group}: {name}");
    }
    for Unchecked { rule, instead } in UNCHECKED {
        outln!("{rule:<16}  no check: {instead}");
    }
}

/// Numbers of checks by status.
#[derive(Default)]
struct Counts {
    passed: usize,
    failed: usize,
    not_judged: usize,
    skipped: usize,
}

impl Counts {
    fn of(results: &[CheckResult]) -> Self {
        let mut counts = Self::default();
        for result in results {
            *match result.status {
                CheckStatus::Passed => &mut counts.passed,
                CheckStatus::Failed { .. } => &mut counts.failed,
                CheckStatus::NotJudged { .. } => &mut counts.not_judged,
                CheckStatus::Skipped { .. } => &mut counts.skipped,
            } += 1;
        }
        counts
    }
}

struct Printer<'a> {
    connection: &'a Connection,
    /// Description of the drive under test.
    device: String,
    results: Vec<CheckResult>,
    supervisor: &'a Supervisor,
    /// Whether the results are printed at the end instead.
    is_silent: bool,
    bench_mode: Option<PowerStage>,
    time_limit: Duration,
    /// From the first result on an interruption ends the checks and not the program.
    signals: Option<SignalGuard<'a>>,
}

impl Reporter for Printer<'_> {
    fn connected(&mut self, identity: &Identity) {
        self.signals = Some(self.supervisor.guard_signals());
        self.device = self.connection.description(identity);
        if !self.is_silent {
            outln!("{}", self.device);
        }
    }

    fn checked(&mut self, result: &CheckResult) {
        self.results.push(result.clone());
        if self.is_silent {
            return;
        }
        let CheckResult { group, rules, name, status, note, .. } = result;
        let note = if note.is_empty() { String::new() } else { format!(" ({note})") };
        match status {
            CheckStatus::Passed => outln!("PASS        {rules}  {group}: {name}{note}"),
            CheckStatus::Failed { expected, got } => {
                outln!("FAIL        {rules}  {group}: {name}{note}; expected {expected}, got {got}");
            }
            CheckStatus::NotJudged { cause } => outln!("NOT JUDGED  {rules}  {group}: {name}; {cause}"),
            CheckStatus::Skipped { reason } => outln!("SKIPPED     {rules}  {group}: {name}; {reason}"),
        }
    }

    fn bench_mode(&self) -> Option<PowerStage> {
        self.bench_mode
    }

    fn time_limit(&self) -> Duration {
        self.time_limit
    }

    fn is_interrupted(&self) -> bool {
        self.supervisor.interrupted()
    }
}
