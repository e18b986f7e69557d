//! Options that several commands share: the drive, its line, the scenario.

use std::path::{Path, PathBuf};

use clap::{Args, Command};
use lashloop_bench::device::{self, DeviceChoice, kinds};
use lashloop_bench::process_plant;
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_firmware::Laws;
use lashloop_plant::Plants;
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;

use super::error::CliError;
use lashloop::Bench;
use lashloop::rig::TakenRig;

/// Speed of a serial port without a scenario, in bit/s.
pub(super) const DEFAULT_BAUD: u32 = 921_600;

#[derive(Args)]
pub(super) struct DeviceOption {
    #[arg(long, global = true, default_value = "native", value_name = "DEVICE", help = drive_help())]
    pub(super) device: DeviceChoice,
}

/// The text of `--device` in short.
pub(super) fn drive_help() -> String {
    format!("Drive: {}; see `lashloop run --help`", device::forms(&kinds::all::<Laws>()))
}

#[derive(Args)]
pub(super) struct BaudOption {
    /// Speed of a serial port, in bit/s
    #[arg(long, global = true, default_value_t = DEFAULT_BAUD, value_parser = clap::value_parser!(u32).range(1200..=12_000_000))]
    pub(super) baud: u32,
}

/// Id of every option that takes a device.
pub(super) const DEVICE: &str = "device";

/// Makes the options that take a device parse the devices of this bench.
pub(super) fn with_devices(command: Command, bench: &Bench) -> Command {
    let command = command.mut_subcommands(|command| with_devices(command, bench));
    let devices = bench.devices();
    let takes_device = command.get_arguments().any(|argument| argument.get_id() == DEVICE);
    let parse = move |text: &str| DeviceChoice::parse(text, &devices);
    if takes_device { command.mut_arg(DEVICE, |argument| argument.value_parser(parse)) } else { command }
}

/// Models of plants that scenarios may choose. This program is the guard of a plant in a process.
pub(super) fn plants(bench: &Bench) -> Plants {
    let program = std::env::current_exe().ok();
    bench.plants().with(process_plant::model(program.clone())).with(process_plant::fmu(program))
}

#[derive(Args)]
pub(super) struct ScenarioOptions {
    /// Scenario in TOML: plant, encoders, controller, reference and expectations
    scenario: PathBuf,

    /// Value instead of the scenario's, such as plant.dead_zone_rad=0.2; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,
}

impl ScenarioOptions {
    pub(super) fn file(&self) -> &PathBuf {
        &self.scenario
    }

    /// The scenario, and what a record keeps of its origin. `more` applies after the settings.
    pub(super) fn read_with_source(
        self,
        more: impl IntoIterator<Item = Override>,
        bench: &Bench,
    ) -> Result<(Scenario, RunSource), CliError> {
        let overrides: Vec<_> = self.set.into_iter().map(Override::Set).chain(more).collect();
        let plants = plants(bench);
        let scenario = Scenario::from_file_with(&self.scenario, &overrides, &plants)?;
        Ok((scenario, RunSource::new(&self.scenario, &overrides, &plants)))
    }
}

#[derive(Args)]
pub(super) struct RigOption {
    /// Rig file in TOML: device, limits and loader of a bench with hardware; no second program gets the rig meanwhile
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,
}

impl RigOption {
    /// Reads and locks the rig; `None` without one. `purpose` is what the program does, for the message of a second program.
    pub(super) fn take(&self, bench: &Bench, purpose: &str) -> Result<Option<TakenRig>, CliError> {
        let take = |file: &Path| TakenRig::take(file, &bench.devices(), purpose);
        Ok(self.rig.as_deref().map(take).transpose()?)
    }
}

/// Where a record goes.
#[derive(Args)]
pub(super) struct RecordOptions {
    /// Folder for the record: manifest, resolved scenario, samples and summary; `latest` next to it points to it
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,

    /// Replace the record that the folder of --out holds
    #[arg(long, requires = "out")]
    pub(super) force: bool,

    /// Write the record as CSV too, as `lashloop export --to csv` does: export.csv in the folder of --out
    #[arg(long, requires = "out")]
    pub(super) csv: bool,
}

impl RecordOptions {
    /// Claims the folder for a run of this scenario; `None` without one.
    pub(super) fn claim(&self, scenario: &Path) -> Result<Option<RecordFolder>, CliError> {
        let Some(path) = &self.out else { return Ok(None) };
        let folder = RecordFolder::claim(path, self.force)?;
        folder.check_source(scenario)?;
        Ok(Some(folder))
    }
}

/// A number above 0.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let value = text.parse().map_err(|_| format!("{text:?} isn't a number"))?;
    if value > 0.0 && f64::is_finite(value) { Ok(value) } else { Err(format!("{value} is not above 0")) }
}
