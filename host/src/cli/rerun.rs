//! `lashloop rerun`: the scenario of a record, run again and compared with the record.

use std::env;
use std::ffi::OsString;
use std::ops::RangeInclusive;
use std::path::{self, Path, PathBuf};

use clap::{Args, CommandFactory as _, FromArgMatches as _, Parser};
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::End;
use lashloop_bench::session::printable;
use lashloop_bench::verdict::Exit;
use lashloop_record::diff::{Comparison, DiffOptions, RecordFiles, Tolerances};
use lashloop_record::manifest::{Manifest, RealTimeOptions};
use lashloop_record::trace::TIME;

use super::diff::{JudgedOptions, print};
use super::error::{CliError, system};
use super::options::with_device;
use super::output::outln;
use super::run;
use crate::bench::Bench;

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

    /// Value in place of the record's, such as plant.dead_zone_rad=0.2; repeatable
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

/// The words after `lashloop run`.
#[derive(Parser)]
#[command(name = "rerun", no_binary_name = true)]
struct RunWords {
    #[command(flatten)]
    run: run::Arguments,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let record = RecordFiles::read(&self.record)?;
        let unusable = |problem: String| CliError::Rerun { record: self.record.clone(), problem };
        let manifest = &record.record.manifest;
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
        let words = self.words(manifest, &out).map_err(unusable)?;
        // The device of the record names its files from there.
        if let (None, Some(folder)) = (&self.device, &manifest.working_directory)
            && Path::new(folder).is_dir()
        {
            env::set_current_dir(folder).map_err(system("change to the working directory of the run"))?;
        }
        let matches = with_device(RunWords::command(), bench).try_get_matches_from(words);
        let parsed = matches.and_then(|matches| RunWords::from_arg_matches(&matches));
        let executed = parsed.map_err(|error| unusable(error.to_string()))?.run.execute(bench)?;
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
        Ok(if executed.outcome.end == End::Interrupted { Exit::Invalid } else { exit })
    }

    /// The words of `lashloop run` that repeat the run.
    fn words(&self, manifest: &Manifest, out: &Path) -> Result<Vec<OsString>, String> {
        let absolute = |path: &Path| path::absolute(path).map_err(|error| error.to_string());
        let mut words = vec![absolute(&self.record.join("scenario.toml"))?.into()];
        match (&self.rig, &self.device) {
            (Some(rig), _) => words.extend(["--rig".into(), absolute(rig)?.into()]),
            (None, Some(device)) => words.extend(["--device".into(), device.to_string().into()]),
            (None, None) => match &manifest.rig {
                Some(rig) => {
                    return Err(format!(
                        "the run was on the rig of {rig}: give --rig {rig}, whose limits a run keeps"
                    ));
                }
                None => {
                    let device = &manifest.device;
                    // A record may come from others, and reading it is not to start what it names.
                    if device.starts_with("exec:") {
                        let named = printable(device);
                        return Err(format!(
                            "the drive was a program, which a record does not start: give --device '{named}', whose path \
                             begins in the present folder"
                        ));
                    }
                    words.extend(["--device".into(), device.into()]);
                }
            },
        }
        words.extend(["--out".into(), out.into()]);
        if let Some(RealTimeOptions { spin_us, fifo, lock_memory, core }) = &manifest.real_time {
            words.extend([
                "--clock".into(),
                "real-time".into(),
                "--spin-us".into(),
                spin_us.to_string().into(),
            ]);
            words.extend(fifo.iter().flat_map(|fifo| ["--fifo".into(), fifo.to_string().into()]));
            words.extend(core.iter().flat_map(|core| ["--core".into(), core.to_string().into()]));
            words.extend(lock_memory.then(|| "--lock-memory".into()));
        }
        words.extend(self.force.then(|| "--force".into()));
        words.extend(self.csv.then(|| "--csv".into()));
        for setting in &self.set {
            words.extend(["--set".into(), setting.into()]);
        }
        Ok(words)
    }
}

/// The time that a record has, if it has a part of its run only, as the records of a soak do. The end of an interrupted run
/// is none that the user has chosen.
fn part_s(files: &RecordFiles) -> Option<RangeInclusive<f64>> {
    let times_s = files.record.trace.get(TIME)?;
    let (first_s, last_s) = (*times_s.first()?, *times_s.last()?);
    let steps = files.record.summary.as_ref().map(|summary| summary.steps);
    let is_part = first_s > 0.0 || steps.is_some_and(|steps| steps != times_s.len() as u64);
    is_part.then_some(first_s..=last_s)
}
