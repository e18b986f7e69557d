//! `lashloop run`: one scenario on one device.

use std::path::{Path, PathBuf};

use clap::Args;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::scenario::Override;
use lashloop_bench::verdict::{Exit, Verdict};

use super::clock_options::ClockOptions;
use super::error::CliError;
use super::one_run::{Gate, OneRun};
use super::options::{RecordOptions, RigOption, ScenarioOptions};
use super::output::{print_json, warn};
use super::watch_options::WatchOptions;
use super::{report_files, run_junit, run_report};
use lashloop::Bench;
use lashloop::execution::{Finished, Place};
use lashloop_campaign::suite::case_result::CaseResult;

/// Run a scenario on a drive and print its verdict
#[derive(Args)]
pub(crate) struct Arguments {
    /// Drive: `inproc` is a call in this process, `native` a process on a pseudo-terminal, `qemu` the Cortex-M image of
    /// `cargo xtask image` in QEMU (`qemu:ELF` another image), `silicon` the same image on virtual silicon (`silicon:ELF`
    /// another), `exec:CMD ARGS` a program of yours on its standard input and output or, with `{tty}` among the arguments,
    /// on a pseudo-terminal, `tcp:HOST:PORT` a port of raw bytes, `rfc2217:HOST:PORT` a serial port of another machine, and
    /// a path such as /dev/ttyACM0 or /dev/pts/3 a terminal with a drive at its far end
    #[arg(long, default_value = "native", value_name = "DEVICE", conflicts_with = "rig")]
    device: DeviceChoice,

    #[command(flatten)]
    rig: RigOption,

    /// Mode instead of the scenario's: in `hil` the bench simulates the plant, in `bench` the drive reads its own encoders
    /// and commands its power stage
    #[arg(long, value_name = "MODE", value_parser = ["hil", "bench"])]
    mode: Option<String>,

    /// Law instead of the scenario's: any that the drive has, see `lashloop parameters list`
    #[arg(long, value_name = "NAME")]
    controller: Option<String>,

    #[command(flatten)]
    scenario: ScenarioOptions,

    #[command(flatten)]
    clock: ClockOptions,

    #[command(flatten)]
    watch: WatchOptions,

    #[command(flatten)]
    record: RecordOptions,

    /// Write the record as a page for a browser too: report.html in the folder of --out
    #[arg(long, requires = "out")]
    report: bool,

    /// Give no verdict if the plant model of the scenario does not follow the recorded motion: the law then ran on another
    /// plant. FILE is the estimates.json of `commission` or `identify`, whose intervals the model may use
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    gate: Option<Option<PathBuf>>,

    /// File for every frame on the line, for Wireshark or `lashloop decode`
    #[arg(long, value_name = "FILE.pcapng")]
    capture: Option<PathBuf>,

    /// File for the verdict and its reasons as JUnit XML
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,

    /// Also print line, timing, torque digest, and metrics without a value
    #[arg(long)]
    details: bool,

    /// Print the summary as JSON, as in summary.json of the record
    #[arg(long, conflicts_with_all = ["details", "live"])]
    json: bool,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let (junit, has_details, as_json) = (self.junit.clone(), self.details, self.json);
        if let Some(path) = &junit {
            report_files::check(path, std::slice::from_ref(self.scenario.file()))?;
        }
        if let Some(path) = &self.capture {
            report_files::check(path, std::slice::from_ref(self.scenario.file()))?;
        }
        let page = self.record.out.clone().filter(|_| self.report);
        let Finished { scenario, summary, outcome } = self.make(bench).inspect_err(|error| {
            junit.iter().for_each(|path| run_junit::write_error(path, error));
        })?;
        if as_json {
            print_json(&summary)?;
        } else {
            run_report::print(&scenario, &summary, &outcome, has_details);
        }
        if let Some(path) = &junit {
            let result = CaseResult::of_run(&scenario.name, summary.device.clone(), &outcome);
            run_junit::write(path, &result)?;
        }
        // The run has its verdict, with or without its page; but a success has all that was asked for.
        match page.map(|folder| super::report::write(&folder)) {
            Some(Err(error)) if summary.verdict == Verdict::Pass => Err(error),
            Some(Err(error)) => {
                warn(format_args!("no page of the run: {error}"));
                Ok(summary.verdict.into())
            }
            _ => Ok(summary.verdict.into()),
        }
    }

    fn make(self, bench: &Bench) -> Result<Finished, CliError> {
        let law = self.controller.map(Override::Controller);
        let overrides = law.into_iter().chain(self.mode.map(Override::Mode));
        let (scenario, mut source) = self.scenario.read_with_source(overrides, bench)?;
        let clock = self.clock.clock()?;
        let rig = self.rig.take(bench, &format!("run {}", scenario.name))?;
        let place = Place::of(rig.as_ref(), &self.device);
        source.rig = place.rig_file();
        place.check(&scenario)?;
        let gate = self.gate.as_ref().map(|file| Gate::read(file.as_deref())).transpose()?;
        let folder = self.record.claim(Path::new(&scenario.name))?;
        if folder.is_none() && !scenario.scope.is_off() {
            warn(format_args!("no file will have the rows of [scope]: a record has them, see --out"));
        }
        self.junit.as_deref().map_or(Ok(()), run_junit::begin)?;
        let (watch, csv, capture) = (&self.watch, self.record.csv, self.capture.as_deref());
        OneRun { scenario, source, place, clock, folder, csv, watch, capture, gate }.make()
    }
}
