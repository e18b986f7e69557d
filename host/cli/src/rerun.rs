//! `lashloop rerun`: the scenario of a record, run again and compared with the record.

use std::env;
use std::ops::RangeInclusive;
use std::path::{self, Path, PathBuf};

use clap::Args;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::process_plant::is_process;
use lashloop_bench::run::{Clock, End};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::Exit;
use lashloop_record::diff::{Comparison, DiffOptions, RecordFiles, Tolerances};
use lashloop_record::folder::RecordFolder;
use lashloop_record::manifest::Manifest;
use lashloop_record::source::RunSource;
use lashloop_record::trace::TIME;
use lashloop_session::printable;

use super::diff::{JudgedOptions, print};
use super::error::{CliError, system};
use super::one_run::OneRun;
use super::options::plants;
use super::output::outln;
use super::watch_options::WatchOptions;
use lashloop::Bench;
use lashloop::execution::{Finished, Place};
use lashloop::rig::TakenRig;

/// Run the scenario of a record again and compare the results
///
/// The new run has the resolved scenario of the record, its device and its clock; a program as the drive is named anew. Judged is what is the same each time: all of
/// a run in lockstep; in real time, positions and torque up to the first step without a torque in time. Exit codes as
/// `lashloop diff`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of the record
    #[arg(value_name = "DIR")]
    record: PathBuf,

    /// Drive, see `lashloop run --help` [default: that of the record, unless it is a program, exec:]
    #[arg(long, value_name = "DEVICE", conflicts_with = "rig")]
    device: Option<DeviceChoice>,

    /// Rig file, whose limits the run keeps; required for the record of a rig, unless --device names another drive
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,

    /// Connect to the port or address, load the image and start the plant's program that the record names. Without it, rerun
    /// asks for --device, because a record may come from others
    #[arg(long)]
    trust: bool,

    /// Value instead of the record's, such as plant.dead_zone_rad=0.2; repeatable
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    set: Vec<String>,

    /// Folder for the new record [default: none is kept]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Replace a record in that folder
    #[arg(long, requires = "out")]
    force: bool,

    /// Write the new record as CSV too, see `lashloop run --help`
    #[arg(long, requires = "out")]
    csv: bool,

    #[command(flatten)]
    judged: JudgedOptions,
}

/// Drives that a record may choose: they have no place outside of this program and its builds.
const OF_THIS_PROGRAM: [&str; 4] = ["native", "inproc", "qemu", "silicon"];

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let record = RecordFiles::read(&self.record)?;
        let part_s = part_s(&record);
        let whole = DiffOptions::default();
        let options = DiffOptions {
            tolerances: Tolerances(self.judged.tolerance.clone()),
            only: self.judged.only.clone(),
            deterministic: true,
            window_s: part_s.clone().unwrap_or(whole.window_s),
        };
        options.check_names(&record)?;
        let temporary = tempfile::tempdir().map_err(system("create a temporary folder"))?;
        let out = self.out.clone().unwrap_or_else(|| temporary.path().join("rerun"));
        let out = path::absolute(out).map_err(system("find the working directory"))?;
        let finished = self.make(&record.record.manifest, &out, bench)?;
        if let Some(part_s) = part_s.as_ref().filter(|_| !self.judged.json) {
            outln!(
                "The record has a part of its run, from {:.6} s to {:.6} s, and this part is compared; metrics and verdict are not \
                 judged.",
                part_s.start(),
                part_s.end()
            );
        }
        let mut again = RecordFiles::read(&out)?;
        again.name = self.out.map_or_else(|| "this run".to_owned(), |out| out.display().to_string());
        let exit = print(&Comparison::new(&[record, again], &options)?, self.judged.json)?;
        Ok(if finished.outcome.end == End::Interrupted { Exit::Invalid } else { exit })
    }

    /// Makes the run of the record again.
    fn make(&self, manifest: &Manifest, out: &Path, bench: &Bench) -> Result<Finished, CliError> {
        let absolute = |path: &Path| path::absolute(path).map_err(system("find the working directory"));
        let file = absolute(&self.record.join("scenario.toml"))?;
        let take = |file: &Path| {
            let purpose = format!("rerun {}", manifest.scenario.path);
            TakenRig::take(&absolute(file)?, &bench.devices(), &purpose).map_err(CliError::from)
        };
        let (rig, device);
        let place = match self.rig.as_deref() {
            Some(file) => {
                rig = take(file)?;
                Place::Rig(&rig)
            }
            None => {
                device = self.device(manifest, bench).map_err(|problem| self.unusable(problem))?;
                Place::Device(&device)
            }
        };
        // The device of the record names its files from there.
        if let (None, Some(folder)) = (&self.device, &manifest.working_directory)
            && Path::new(folder).is_dir()
        {
            env::set_current_dir(folder).map_err(system("change to the working directory of the run"))?;
        }
        let (overrides, plants) =
            (self.set.iter().cloned().map(Override::Set).collect::<Vec<_>>(), plants(bench));
        let scenario = Scenario::from_file_with(&file, &overrides, &plants)?;
        if !self.trust && is_process(scenario.plant.model.name()) {
            return Err(self.unusable(
                "its plant is a program, and a record may come from others: give --trust to start it"
                    .to_owned(),
            ));
        }
        let mut source = RunSource::new(&file, &overrides, &plants);
        source.rig = place.rig_file();
        let clock = match manifest.clock {
            ClockName::Lockstep => Clock::Lockstep,
            ClockName::RealTime => Clock::RealTime(manifest.real_time.unwrap_or_default().into()),
        };
        place.check(&scenario)?;
        let folder = RecordFolder::claim(out, self.force)?;
        folder.check_source(Path::new(&scenario.name))?;
        let (folder, csv, watch) = (Some(folder), self.csv, &WatchOptions::default());
        OneRun { scenario, source, place, clock, folder, csv, watch, capture: None, gate: None }.make()
    }

    /// The device of the options, else that of the record.
    fn device(&self, manifest: &Manifest, bench: &Bench) -> Result<DeviceChoice, String> {
        match (&self.device, &manifest.rig) {
            (Some(device), _) => Ok(device.clone()),
            (None, Some(rig)) => {
                let (rig, quoted) = (printable(rig), quoted(rig));
                Err(format!("the run was on the rig of {rig}: give --rig {quoted}, whose limits a run keeps"))
            }
            // A record may come from others, and reading it is not to start what it names.
            (None, None) if manifest.device.starts_with("exec:") => Err(format!(
                "the drive was a program, which a record does not start: give --device {}, whose path begins in the present \
                 folder",
                quoted(&manifest.device)
            )),
            (None, None) if !self.trust && !OF_THIS_PROGRAM.contains(&&*manifest.device) => Err(format!(
                "the record names the drive at {}, and a record may come from others: give --trust to connect to it, or \
                 --device {}",
                printable(&manifest.device),
                quoted(&manifest.device)
            )),
            (None, None) => DeviceChoice::parse(&manifest.device, &bench.devices()),
        }
    }

    fn unusable(&self, problem: String) -> CliError {
        CliError::Rerun { record: self.record.clone(), problem }
    }
}

/// The time that a record has, if it has a part of its run only, as the records of a soak do. The end of an interrupted run
/// isn't one that the user has chosen.
fn part_s(files: &RecordFiles) -> Option<RangeInclusive<f64>> {
    let times_s = files.record.trace.get(TIME)?;
    let (first_s, last_s) = (*times_s.first()?, *times_s.last()?);
    let steps = files.record.summary.as_ref().map(|summary| summary.steps);
    let is_part = first_s > 0.0 || steps.is_some_and(|steps| steps != times_s.len() as u64);
    is_part.then_some(first_s..=last_s)
}

/// A text of a record as one word of a shell, which a reader may copy.
fn quoted(text: &str) -> String {
    format!("'{}'", printable(text).replace('\'', r"'\''"))
}
