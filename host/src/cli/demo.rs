//! `lashloop demo`: the paper's four runs, a table and a picture.

use std::fs;
use std::path::PathBuf;

use clap::Args;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::{Device, DeviceChoice};
use lashloop_bench::record::trace::TraceRow;
use lashloop_bench::run::DeviceUnderTest;
use lashloop_bench::run::{self, Clock, Outcome, Step, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::sections::LinkSettings;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::{Exit, Verdict};
use lashloop_plant::metrics::{Measured, Metric};
use lashloop_report::demo::{DemoRun, DemoRuns, PlantRuns, before_after};

use super::error::CliError;
use super::progress::Progress;
use super::start_supervisor;

/// The paper's scenarios, within the program, so that the demo runs anywhere.
pub(super) const SCENARIOS: [(&str, &str); 4] = [
    ("scenarios/smooth-before.toml", include_str!("../../../scenarios/smooth-before.toml")),
    ("scenarios/smooth-after.toml", include_str!("../../../scenarios/smooth-after.toml")),
    ("scenarios/friction-before.toml", include_str!("../../../scenarios/friction-before.toml")),
    ("scenarios/friction-after.toml", include_str!("../../../scenarios/friction-after.toml")),
];

/// What the paper says to each scenario, and the metric that answers it.
const PAPER: [(&str, Metric, &str); 4] = [
    ("smooth plant, before: into 0.05 rad", Metric::SettleTime, "about 13 s"),
    ("smooth plant, after: into 0.05 rad", Metric::SettleTime, "about 5.2 s"),
    ("with friction, before: static error", Metric::StaticError, "0.32 rad"),
    ("with friction, after: static error", Metric::StaticError, "eliminated"),
];

const PICTURE: &str = "demo.svg";

/// Run the paper's four scenarios: a table and a picture of before and after.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The drive, as for `run`
    #[arg(long, default_value = "native", value_name = "DEVICE")]
    device: DeviceChoice,

    /// Folder for the picture, demo.svg
    #[arg(long, default_value = "out", value_name = "DIR")]
    out: PathBuf,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let failed = |source| CliError::Output { path: self.out.clone(), source };
        fs::create_dir_all(&self.out).map_err(failed)?;
        let scenarios = SCENARIOS.map(|(name, text)| Scenario::from_str(name, text, &[]));
        let supervisor = start_supervisor()?;
        let mut device: Option<DeviceUnderTest> = None;
        let mut worst = Verdict::Pass;
        let mut runs = Vec::new();
        let mut dead_zone_rad = f64::NAN;
        for (scenario, (what, metric, paper)) in scenarios.into_iter().zip(PAPER) {
            let scenario = scenario?;
            let device = match &mut device {
                Some(device) => device,
                None => device.insert(self.open(&scenario.link, &supervisor)?),
            };
            let mut history = History::new(&scenario, &supervisor);
            let _heed = supervisor.guard_signals();
            let outcome = run::run(&scenario, device, Clock::Lockstep, &mut history)?;
            let here = here(outcome.metrics.get(metric), metric);
            let verdict = outcome.judgement.verdict;
            dead_zone_rad = scenario.plant.dead_zone_rad;
            runs.push(history.into_run(&outcome));
            say!("{what:<38} {paper:>12} {here:>12}  {verdict}");
            worst = worst.max(verdict);
            if supervisor.interrupted() {
                return Ok(worst.into());
            }
        }
        let [smooth_before, smooth_after, friction_before, friction_after] =
            <[DemoRun; 4]>::try_from(runs).expect("one run for each scenario");
        let figure = before_after(&DemoRuns {
            smooth: PlantRuns { before: smooth_before, after: smooth_after },
            friction: PlantRuns { before: friction_before, after: friction_after },
            dead_zone_rad,
        });
        let path = self.out.join(PICTURE);
        fs::write(&path, figure.to_svg())
            .map_err(|source| CliError::Output { path: path.clone(), source })?;
        say!("picture: {}", path.display());
        Ok(worst.into())
    }

    fn open(&self, link: &LinkSettings, supervisor: &Supervisor) -> Result<DeviceUnderTest, CliError> {
        let device = Device::open(&self.device, link, supervisor)?;
        say!("{}", device.description());
        say!("{:<38} {:>12} {:>12}  verdict", "", "paper", "here");
        Ok(device.into())
    }
}

fn here(measured: Measured, metric: Metric) -> String {
    match measured.value() {
        Some(value) if metric == Metric::SettleTime => format!("{value:.2} s"),
        Some(value) => format!("{value:.4} rad"),
        None => measured.to_string(),
    }
}

/// Keeps what the picture shows.
struct History<'a> {
    rows: Vec<TraceRow>,
    progress: Progress,
    supervisor: &'a Supervisor,
}

impl<'a> History<'a> {
    fn new(scenario: &Scenario, supervisor: &'a Supervisor) -> Self {
        Self { rows: Vec::new(), progress: Progress::of(scenario), supervisor }
    }

    fn into_run(self, outcome: &Outcome) -> DemoRun {
        let column = |value: fn(&TraceRow) -> f64| self.rows.iter().map(value).collect::<Vec<_>>();
        DemoRun {
            time_s: column(|row| row.time_s),
            load_position_rad: column(|row| row.load_position_rad),
            torque_nm: column(|row| row.torque_nm),
            dead_zone_estimate_rad: column(|row| row.dead_zone_estimate_rad),
            settle_time_s: outcome.metrics.get(Metric::SettleTime).value(),
            static_error_rad: outcome.metrics.get(Metric::StaticError).value().unwrap_or(f64::NAN),
        }
    }
}

impl StepObserver for History<'_> {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.progress.step();
        self.rows.push(step.row);
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.supervisor.interrupted()
    }
}
