//! `lashloop paper`: the paper's figures and numbers, reproduced.

use std::path::PathBuf;

use crate::bench::Bench;
use clap::Args;
use lashloop_bench::run::simulator::Simulator;
use lashloop_bench::run::{Clock, Observation, RunError};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::verdict::{Exit, Verdict};
use lashloop_plant::metrics::SignalTable;
use lashloop_record::columns::Columns;
use lashloop_record::row::Row;
use lashloop_record::trace::columns;
use lashloop_report::paper::{Laws, PAPER, Run, Runs, figures, file_name, page, tables};

use super::error::CliError;
use super::history::run_for_figure;
use super::options::DeviceOption;
use super::output::{outln, prepare_folder, write_file};
use super::paper_scenarios::SCENARIOS;
use super::supervision::start_supervisor;
use crate::execution::OpenDrive;

const SHAFT: [(&str, &str); 5] = [
    ("scenarios/shaft-pd.toml", include_str!("../../../scenarios/shaft-pd.toml")),
    ("scenarios/shaft-merzouki.toml", include_str!("../../../scenarios/shaft-merzouki.toml")),
    ("scenarios/shaft-braking-curve.toml", include_str!("../../../scenarios/shaft-braking-curve.toml")),
    ("scenarios/shaft-sine.toml", include_str!("../../../scenarios/shaft-sine.toml")),
    (
        "scenarios/shaft-braking-curve-sine.toml",
        include_str!("../../../scenarios/shaft-braking-curve-sine.toml"),
    ),
];

/// The expectations of a scenario hold for its own control law.
const WITHOUT_EXPECTATIONS: &str = "expect=[]";

const BEFORE: &str = "pd";
const BEYOND: &str = "braking-curve";

/// One plant under three laws: a scenario for each, and the law where it is not the scenario's.
type Plan = [((&'static str, &'static str), Option<&'static str>); 3];

const PLANS: [Plan; 4] = [
    [(SCENARIOS[0], None), (SCENARIOS[1], None), (SCENARIOS[1], Some(BEYOND))],
    [(SCENARIOS[2], None), (SCENARIOS[3], None), (SCENARIOS[3], Some(BEYOND))],
    [(SHAFT[0], None), (SHAFT[1], None), (SHAFT[2], None)],
    [(SHAFT[3], Some(BEFORE)), (SHAFT[3], None), (SHAFT[4], None)],
];

/// Last period of the slow sine, which the figures show.
const SINE_SHOWN_S: f64 = 20.0;

/// Range and steps of the twist in figure 5.
const TWIST_RAD: f64 = 2.0;
const TWISTS: i32 = 400;

const INDEX: &str = "index.html";

/// Reproduce the paper's figures and print its numbers next to ours
///
/// Runs three plants and a slow sine under three laws: the cascaded PD law (before), the paper's compensation (after) and
/// the fastest of Lashloop's own laws, which inverts the gap along a braking curve (beyond). Writes figure-05.svg,
/// figure-07.svg to figure-17.svg, and index.html with all of them.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    drive: DeviceOption,

    /// Folder for the figures and index.html
    #[arg(long, default_value = "out/paper", value_name = "DIR")]
    out: PathBuf,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let supervisor = start_supervisor()?;
        prepare_folder(&self.out, &[INDEX])?;
        let mut first = scenario(SCENARIOS[0], None)?;
        let mut drive =
            OpenDrive::open(&mut first, (&self.drive.device).into(), Clock::Lockstep, &supervisor)?;
        outln!("{}", drive.device().description());
        let mut worst = Verdict::Pass;
        let mut all = Vec::new();
        for plan in PLANS {
            let mut laws = Vec::new();
            for (file, law) in plan {
                let scenario = scenario(file, law)?;
                let (name, law) = (scenario.name.clone(), scenario.controller.name.clone());
                let shown_from_s = shown_from_s(&scenario);
                let (run, verdict) = run_for_figure(&mut drive, scenario, shown_from_s, &supervisor, None)?;
                outln!("{name:<40} {law:<14} {verdict}");
                laws.push(run);
                worst = worst.max(verdict);
                if supervisor.interrupted() {
                    return Ok(worst.into());
                }
            }
            let [before, after, beyond] = <[Run; 3]>::try_from(laws).expect("one run for each law");
            all.push(Laws { before, after, beyond });
        }
        let [smooth, friction, shaft, sine] = <[Laws; 4]>::try_from(all).expect("one set for each plan");
        let twisted = |file| twist(scenario(file, None)?);
        let ratio = scenario(SCENARIOS[0], None)?.plant.number("reduction_ratio").unwrap_or(f64::NAN);
        let (smooth_gap, hard_gap) = (twisted(SCENARIOS[0])?, twisted(SHAFT[0])?);
        let runs = Runs { smooth, friction, shaft, sine, smooth_gap, hard_gap, ratio };
        self.report(&runs, &drive.device().description())?;
        Ok(worst.into())
    }

    /// Prints the tables and writes the figures, the page that shows them last.
    fn report(&self, runs: &Runs, device: &str) -> Result<(), CliError> {
        let tables = tables(runs);
        for table in &tables {
            outln!("\n{table}");
        }
        let figures = figures(runs);
        for (number, figure) in &figures {
            write_file(&self.out.join(file_name(*number)), &figure.to_svg())?;
        }
        let version = env!("CARGO_PKG_VERSION");
        let index = self.out.join(INDEX);
        let source = format!("Drawn by lashloop {version} from runs on {device}.");
        write_file(&index, &page(&PAPER, &figures, &tables, &source))?;
        outln!("\nfigures: {}", index.display());
        Ok(())
    }
}

fn scenario((name, text): (&str, &str), law: Option<&str>) -> Result<Scenario, CliError> {
    let overrides =
        law.map(|law| [Override::Controller(law.to_owned()), Override::Set(WITHOUT_EXPECTATIONS.to_owned())]);
    Ok(Scenario::from_str(name, text, overrides.as_ref().map_or(&[], |overrides| overrides))?)
}

/// Start of the rows that the figures show: of a sine only the last period.
fn shown_from_s(scenario: &Scenario) -> f64 {
    match scenario.reference.middle_rad() {
        Some(_) => f64::from(scenario.run.steps()) * scenario.run.control_period_s() - SINE_SHOWN_S,
        None => 0.0,
    }
}

/// The plant of a scenario at rest, at each twist in turn.
fn twist(mut scenario: Scenario) -> Result<Columns, CliError> {
    let mut trace: Option<Columns> = None;
    for step in -TWISTS..=TWISTS {
        let initial = &mut scenario.plant.initial;
        initial.load_position_rad = 0.0;
        initial.motor_position_rad = TWIST_RAD * f64::from(step) / f64::from(TWISTS);
        let mut simulator = Simulator::new(&scenario)?;
        let (_, Observation { row, plant }) = simulator.observe(0).map_err(RunError::from)?;
        let trace = trace.get_or_insert_with(|| {
            let signals = SignalTable { plant: simulator.signals().to_vec(), drive: Vec::new() };
            Columns::new(columns(&signals))
        });
        // No drive has sent telemetry, and none has taken a sample.
        trace.push(row.values().chain(plant).chain([f64::NAN; 4]));
    }
    Ok(trace.unwrap_or_default())
}
