//! `lashloop demo`: the paper's four runs as a table and a figure.

use std::path::PathBuf;

use crate::bench::Bench;
use clap::Args;
use lashloop_bench::run::Clock;
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::{Exit, Verdict};
use lashloop_plant::metrics::{Measured, Metric};
use lashloop_report::demo::{DemoRuns, PlantRuns, before_after};
use lashloop_report::paper::Run;

use super::error::CliError;
use super::history::run_for_figure;
use super::options::DeviceOption;
use super::output::{outln, prepare_folder, write_file};
use super::paper_scenarios::SCENARIOS;
use super::supervision::start_supervisor;
use crate::execution::OpenDrive;

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
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        prepare_folder(&self.out, &[])?;
        let scenarios = SCENARIOS.map(|(name, text)| Scenario::from_str(name, text, &[]));
        let scenarios = scenarios.into_iter().collect::<Result<Vec<_>, _>>()?;
        let supervisor = start_supervisor()?;
        let mut first = scenarios[0].clone();
        let mut drive =
            OpenDrive::open(&mut first, (&self.drive.device).into(), Clock::Lockstep, &supervisor)?;
        outln!("{}", drive.device().description());
        outln!("{:<38} {:>12} {:>12}  verdict", "", "paper", "here");
        let mut worst = Verdict::Pass;
        let mut runs = Vec::new();
        let mut dead_zone_rad = f64::NAN;
        for (scenario, (what, metric, paper)) in scenarios.into_iter().zip(PAPER) {
            dead_zone_rad = scenario.plant.number("dead_zone_rad").unwrap_or(f64::NAN);
            let (run, verdict) = run_for_figure(&mut drive, scenario, 0.0, &supervisor, None)?;
            let here = here(run.metrics.get(metric), metric);
            runs.push(run);
            outln!("{what:<38} {paper:>12} {here:>12}  {verdict}");
            worst = worst.max(verdict);
            if supervisor.interrupted() {
                return Ok(worst.into());
            }
        }
        let [smooth_before, smooth_after, friction_before, friction_after] =
            <[Run; 4]>::try_from(runs).expect("one run for each scenario");
        let figure = before_after(&DemoRuns {
            smooth: PlantRuns { before: smooth_before, after: smooth_after },
            friction: PlantRuns { before: friction_before, after: friction_after },
            dead_zone_rad,
        });
        let path = self.out.join(FIGURE_FILE);
        write_file(&path, &figure.to_svg())?;
        outln!("figure: {}", path.display());
        Ok(worst.into())
    }
}

fn here(measured: Measured, metric: Metric) -> String {
    match measured.value() {
        Some(value) if metric == Metric::SettleTime => format!("{value:.2} s"),
        Some(value) => format!("{value:.4} rad"),
        None => measured.to_string(),
    }
}
