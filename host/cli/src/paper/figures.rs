//! `lashloop paper figures`: the paper's figures and numbers, reproduced.

use std::path::PathBuf;

use clap::Args;
use lashloop::Bench;
use lashloop_bench::run::Clock;
use lashloop_bench::verdict::{Exit, Verdict};
use merzouki_2005::figures::{Laws, PAPER, Run, Runs, figures, file_name, page, tables};
use merzouki_2005::plan::{PLANS, SHAFT, scenario, shown_from_s, twist};
use merzouki_2005::scenarios::SCENARIOS;

use super::history::run_for_figure;
use crate::error::CliError;
use crate::options::DeviceOption;
use crate::output::{outln, prepare_folder, write_file};
use crate::supervision::start_supervisor;
use lashloop::execution::OpenDrive;

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
        let (first, place) = (scenario(SCENARIOS[0], None)?, (&self.drive.device).into());
        let mut drive = OpenDrive::open(&first, place, Clock::Lockstep, &supervisor)?;
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
        let twisted = |file| -> Result<_, CliError> { Ok(twist(scenario(file, None)?)?) };
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
