//! `lashloop demo`: the paper's four runs as a table and a figure.

use std::fs;
use std::path::PathBuf;

use clap::Args;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::Device;
use lashloop_bench::record::trace::TraceRow;
use lashloop_bench::run::{self, Clock, Outcome, Step, Watcher};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::scenario::sections::LinkSettings;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::{Exit, Verdict};
use lashloop_plant::metrics::{Measured, Metric};
use lashloop_report::demo::{DemoRun, DemoRuns, PlantRuns, before_after};

use super::device_options::DeviceOption;
use super::error::CliError;
use super::output::outln;
use super::paper_scenarios::SCENARIOS;
use super::progress::Progress;
use super::supervision::start_supervisor;

/// The paper's result for each scenario, and the metric to compare it with.
const PAPER: [(&str, Metric, &str); 4] = [
    ("smooth plant, before: into 0.05 rad", Metric::SettleTime, "about 13 s"),
    ("smooth plant, after: into 0.05 rad", Metric::SettleTime, "about 5.2 s"),
    ("with friction, before: static error", Metric::StaticError, "0.32 rad"),
    ("with friction, after: static error", Metric::StaticError, "eliminated"),
];

const FIGURE_FILE: &str = "demo.svg";

/// Run the paper's four scenarios: a table and a figure, before and after compensation
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    drive: DeviceOption,

    /// Folder for the figure, demo.svg
    #[arg(long, default_value = "out", value_name = "DIR")]
    out: PathBuf,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let failed = |source| CliError::Output { path: self.out.clone(), source };
        fs::create_dir_all(&self.out).map_err(failed)?;
        let scenarios = SCENARIOS.map(|(name, text)| Scenario::from_str(name, text, &[]));
        let supervisor = start_supervisor()?;
        let mut device: Option<Device> = None;
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
            let _signals = supervisor.heed_signals();
            let outcome = run::run(&scenario, device, Clock::Lockstep, &mut history)?;
            let here = here(outcome.metrics.get(metric), metric);
            let verdict = outcome.judgement.verdict;
            dead_zone_rad = scenario.plant.dead_zone_rad;
            runs.push(history.into_run(&outcome));
            outln!("{what:<38} {paper:>12} {here:>12}  {verdict}");
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
        let path = self.out.join(FIGURE_FILE);
        fs::write(&path, figure.to_svg())
            .map_err(|source| CliError::Output { path: path.clone(), source })?;
        outln!("figure: {}", path.display());
        Ok(worst.into())
    }

    fn open(&self, link: &LinkSettings, supervisor: &Supervisor) -> Result<Device, CliError> {
        let device = Device::open(&self.drive.device, link, supervisor)?;
        outln!("{}", device.description());
        outln!("{:<38} {:>12} {:>12}  verdict", "", "paper", "here");
        Ok(device)
    }
}

fn here(measured: Measured, metric: Metric) -> String {
    match measured.value() {
        Some(value) if metric == Metric::SettleTime => format!("{value:.2} s"),
        Some(value) => format!("{value:.4} rad"),
        None => measured.to_string(),
    }
}

/// The traces that the figure shows.
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

impl Watcher for History<'_> {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.progress.step();
        self.rows.push(step.row);
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.supervisor.interrupted()
    }
}
