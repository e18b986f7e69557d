//! `lashloop fmu`: what an FMU is and has, and FMUs of a scenario's plant and drive. The program `lashloop-fmu` reads FMUs, as it
//! does in a run.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process;

use clap::{Args, Subcommand, ValueEnum};
use lashloop::Bench;
use lashloop_bench::atomic_file::write_whole;
use lashloop_bench::process_plant;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::verdict::Exit;
use lashloop_fmu_export::{Part, Version, export, library};

use super::error::{CliError, system};
use super::output::outln;
use super::report_files;

/// Inspect an FMU, or write the plant or the drive of a scenario as one
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Print version, kinds, platforms, steps and variables with units, and a [plant] section for the FMU
    Show {
        /// FMU of FMI 1.0, 2.0 or 3.0
        file: PathBuf,
    },
    Export(Export),
}

/// Write the plant or the drive of a scenario as an FMU for co-simulation, without a compiler
///
/// The plant has the encoders and the line to the motor, the drive has the firmware and the reference. A drive steps by the
/// control period. Both coupled, each period the drive first, give the torques of a run in lockstep, bit for bit.
#[derive(Args)]
struct Export {
    /// Scenario in TOML: plant, encoders, controller, reference and expectations
    scenario: PathBuf,

    /// Half of the loop
    #[arg(long, value_name = "PART")]
    of: Of,

    /// Version of FMI
    #[arg(long, default_value = "2", value_name = "VERSION")]
    fmi: Fmi,

    /// Value instead of the scenario's, such as plant.dead_zone_rad=0.2; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,

    /// File [default: SCENARIO-plant.fmu or SCENARIO-drive.fmu in the present folder]
    #[arg(long, value_name = "FILE.fmu")]
    out: Option<PathBuf>,

    /// Library of every FMU [default: liblashloop_fmu.so next to this program or in ../lib/lashloop]
    #[arg(long, value_name = "FILE.so")]
    library: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Of {
    Plant,
    Drive,
}

#[derive(Clone, Copy, ValueEnum)]
enum Fmi {
    #[value(name = "2")]
    Two,
    #[value(name = "3")]
    Three,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        match self.command {
            Command::Show { file } => show(&file),
            Command::Export(options) => options.run(),
        }
    }
}

fn show(file: &Path) -> Result<Exit, CliError> {
    let loader = process_plant::loader()?;
    let status = process::Command::new(loader).arg("show").arg(file).status();
    // It has printed its error.
    let shown = status.map_err(system("start lashloop-fmu"))?.success();
    Ok(if shown { Exit::Pass } else { Exit::UsageOrScenario })
}

impl Export {
    /// The library knows the laws and plants of Lashloop, not those of another program that has this command.
    fn run(self) -> Result<Exit, CliError> {
        let overrides: Vec<_> = self.set.into_iter().map(Override::Set).collect();
        let scenario = Scenario::from_file_with(&self.scenario, &overrides, &Bench::new().plants())?;
        let part = match self.of {
            Of::Plant => Part::Plant,
            Of::Drive => Part::Drive,
        };
        let version = match self.fmi {
            Fmi::Two => Version::Two,
            Fmi::Three => Version::Three,
        };
        let library = self.library.map_or_else(library, Ok)?;
        let fmu = export(&scenario, part, version, &library)?;
        let stem = self.scenario.file_stem().unwrap_or_default().to_string_lossy();
        let file = self.out.unwrap_or_else(|| PathBuf::from(format!("{stem}-{}.fmu", part.name())));
        report_files::check(&file, std::slice::from_ref(&self.scenario))?;
        write_whole(&file, "lashloop-fmu-", |out| out.write_all(&fmu))?;
        outln!("{}: FMI {}, {} of {}", file.display(), version.name(), part.name(), self.scenario.display());
        Ok(Exit::Pass)
    }
}
