//! `lashloop paper demo`: the paper's two plants under three laws, as a table and a figure.

use std::path::PathBuf;

use clap::Args;
use lashloop::Bench;
use lashloop::execution::OpenDrive;
use lashloop_bench::run::Clock;
use lashloop_bench::verdict::{Exit, Verdict};
use merzouki_2005::demo;

use super::history::run_for_figure;
use crate::error::CliError;
use crate::options::DeviceOption;
use crate::output::{outln, prepare_folder, write_file};
use crate::supervision::start_supervisor;

/// Run the paper's two plants before and after compensation and under the law beyond the paper: a table and a figure
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
        let scenarios = demo::scenarios()?;
        let supervisor = start_supervisor()?;
        let place = (&self.drive.device).into();
        let mut drive = OpenDrive::open(&scenarios[0], place, Clock::Lockstep, &supervisor)?;
        outln!("{}", drive.device().description());
        outln!("{}", demo::head());
        let mut worst = Verdict::Pass;
        let mut runs = Vec::new();
        for scenario in &scenarios {
            let (run, verdict) = run_for_figure(&mut drive, scenario.clone(), 0.0, &supervisor, None)?;
            outln!("{}", demo::row(runs.len(), &run, verdict));
            runs.push(run);
            worst = worst.max(verdict);
            if supervisor.interrupted() {
                return Ok(worst.into());
            }
        }
        let path = self.out.join(demo::FIGURE_FILE);
        write_file(&path, &demo::figure(runs, &scenarios).to_svg())?;
        outln!("figure: {}", path.display());
        Ok(worst.into())
    }
}
