//! `lashloop rerun`: the scenario of a record, run again and compared with the record.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory as _, FromArgMatches as _, Parser};
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::End;
use lashloop_bench::verdict::Exit;
use lashloop_record::diff::{Comparison, DiffOptions, RecordFiles, Tolerances};
use serde_json::Value;

use super::diff::{JudgedOptions, print};
use super::error::{CliError, system};
use super::options::with_device;
use super::run;
use crate::bench::Bench;

/// Run the scenario of a record again and compare the results
///
/// The new run has the resolved scenario of the record, its device and its clock. Judged is what is the same each time: all of
/// a run in lockstep; in real time, positions and torque up to the first step without a torque in time. Exit codes as
/// `lashloop diff`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of the record
    #[arg(value_name = "DIR")]
    record: PathBuf,

    /// Drive, see `lashloop run --help` [default: that of the record]
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
        let manifest = record.manifest.as_ref().filter(|_| record.scenario.is_some()).ok_or_else(|| {
            unusable(
                "the record has no scenario: it is of an older format; run its scenario file again"
                    .to_owned(),
            )
        })?;
        let temporary = tempfile::tempdir().map_err(system("create a temporary folder"))?;
        let out = self.out.clone().unwrap_or_else(|| temporary.path().join("rerun"));
        let words = self.words(manifest, &out).map_err(unusable)?;
        let matches = with_device(RunWords::command(), bench).try_get_matches_from(words);
        let parsed = matches.and_then(|matches| RunWords::from_arg_matches(&matches));
        let executed = parsed.map_err(|error| unusable(error.to_string()))?.run.execute(bench)?;
        let options = DiffOptions {
            tolerances: Tolerances(self.judged.tolerance),
            only: self.judged.only,
            deterministic: true,
            ..DiffOptions::default()
        };
        let mut again = RecordFiles::read(&out)?;
        if self.out.is_none() {
            "this run".clone_into(&mut again.name);
        }
        let exit = print(&Comparison::new(&[record, again], &options)?, self.judged.json)?;
        Ok(if executed.outcome.end == End::Interrupted { Exit::Invalid } else { exit })
    }

    /// The words of `lashloop run` that repeat the run.
    fn words(&self, manifest: &Value, out: &Path) -> Result<Vec<OsString>, String> {
        let text = |key: &str| {
            let value = manifest[key].as_str();
            value.map(OsString::from).ok_or_else(|| format!("record.json has no {key}"))
        };
        let line = manifest["command_line"].as_array().map_or(&[][..], |words| words);
        let line: Vec<_> = line.iter().filter_map(Value::as_str).collect();
        let mut words = vec![self.record.join("scenario.toml").into()];
        match (&self.rig, &self.device) {
            (Some(rig), _) => words.extend(["--rig".into(), rig.into()]),
            (None, Some(device)) => words.extend(["--device".into(), device.to_string().into()]),
            (None, None) if option(&line, "--rig").is_some() => {
                return Err("the run was on a rig: give --rig RIG.toml, whose limits a run keeps".to_owned());
            }
            (None, None) => words.extend(["--device".into(), text("device")?]),
        }
        words.extend(["--out".into(), out.into(), "--clock".into(), text("clock")?]);
        if manifest["clock"] == "real-time" {
            let kept = ["--spin-us", "--fifo", "--core"].into_iter();
            for (name, value) in kept.filter_map(|name| Some((name, option(&line, name)?))) {
                words.extend([name, value].map(OsString::from));
            }
            words.extend(line.contains(&"--lock-memory").then(|| "--lock-memory".into()));
        }
        words.extend(self.force.then(|| "--force".into()));
        for setting in &self.set {
            words.extend(["--set".into(), setting.into()]);
        }
        Ok(words)
    }
}

/// The value of an option in a command line, as `--name value` or `--name=value`.
fn option<'a>(line: &[&'a str], name: &str) -> Option<&'a str> {
    line.iter().enumerate().find_map(|(at, word)| match word.strip_prefix(name)? {
        "" => line.get(at + 1).copied(),
        rest => rest.strip_prefix('='),
    })
}
