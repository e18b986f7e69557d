//! `lashloop run`: one scenario on one device.

use std::path::{Path, PathBuf};

use crate::bench::Bench;
use clap::Args;
use lashloop_bench::atomic_file::{WriteError, remove_if_present};
use lashloop_bench::capture::link::Captured;
use lashloop_bench::capture::{self, Capture, WhenFull};
use lashloop_bench::device::{Device, DeviceChoice};
use lashloop_bench::link::Link;
use lashloop_bench::record::summary::{SUMMARY_FILE, Summary, Telemetry, Versions};
use lashloop_bench::record::timing::{TimingRow, TimingWriter};
use lashloop_bench::record::trace::TraceWriter;
use lashloop_bench::run::DeviceUnderTest;
use lashloop_bench::run::{self, Outcome, Step, StepObserver, check_bench_mode};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::{Exit, Verdict};
use lashloop_plant::metrics::SignalTable;

use super::clock_options::ClockOptions;
use super::error::CliError;
use super::options::{RigOption, ScenarioOptions};
use super::output::{error_line, outln, prepare_folder};
use super::progress::Progress;
use super::run_report;
use super::supervision::start_supervisor;
use crate::identify::gate::{self, Intervals, RecordedMotion};
use crate::rig::check::check_board;

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

    /// Mode in place of the scenario's: in `hil` the bench simulates the plant, in `bench` the drive reads its own encoders
    /// and commands its power stage
    #[arg(long, value_name = "MODE", value_parser = ["hil", "bench"])]
    mode: Option<String>,

    /// Law in place of the scenario's: any that the drive has, see `lashloop parameters list`
    #[arg(long, value_name = "NAME")]
    controller: Option<String>,

    #[command(flatten)]
    scenario: ScenarioOptions,

    #[command(flatten)]
    clock: ClockOptions,

    /// Folder for the record: summary.json, trace.csv, trace.json with the units of its columns, and timing.csv
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Give no verdict if the plant model of the scenario does not follow the recorded motion: the law then ran on another
    /// plant. FILE is the estimates.json of `commission` or `identify`, whose intervals the model may use
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    gate: Option<Option<PathBuf>>,

    /// File for every frame on the line, for Wireshark or `lashloop decode`
    #[arg(long, value_name = "FILE.pcapng")]
    capture: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let mut scenario = {
            let law = self.controller.map(Override::Controller);
            self.scenario.read(law.into_iter().chain(self.mode.map(Override::Mode)), bench)?
        };
        let clock = self.clock.clock()?;
        let when_full = match clock.name() {
            ClockName::Lockstep => WhenFull::Wait,
            ClockName::RealTime => WhenFull::Fail,
        };
        let rig = self.rig.take(bench, &format!("run {}", scenario.name))?;
        let choice = match &rig {
            Some(taken) => {
                taken.rig.allows(&scenario)?;
                taken.check_present()?;
                scenario.link.baud = taken.rig.port.baud;
                &taken.rig.port.device
            }
            None => &self.device,
        };
        let gate = self.gate.as_ref().map(|file| Gate::read(file.as_deref())).transpose()?;
        let capture = self.capture.as_deref().map(|path| capture::create(path, when_full)).transpose()?;
        let (recorder, capture) = capture.unzip();
        let supervisor = start_supervisor()?;
        let listen = |link| match recorder {
            Some(recorder) => Box::new(Captured::new(link, recorder)) as Box<dyn Link>,
            None => link,
        };
        let mut device = DeviceUnderTest::open(&scenario, choice, clock.name(), &supervisor, listen)?;
        if let Some(taken) = &rig {
            check_board(&taken.rig, &device.device)?;
            if !scenario.run.mode.is_hil() {
                check_bench_mode(&device.device, clock.name())?;
            }
            taken.rig.complete(&mut scenario, &device.device.session.parameters)?;
        }
        for warning in device.device.warnings() {
            error_line(format_args!("lashloop: warning: {warning}"));
        }
        let record = self.out.as_deref().map(|folder| Folder::prepare(folder, &scenario)).transpose()?;
        let progress = Progress::of(&scenario);
        let mut watcher =
            RunWatcher { record, tables: None, capture, supervisor: &supervisor, progress, gate };
        let signals = supervisor.guard_signals();
        let mut outcome = run::run(&scenario, &mut device, clock, &mut watcher)?;
        let RunWatcher { tables, capture, progress, gate, .. } = watcher;
        drop(progress);
        if let Some(Tables { trace, timing, .. }) = tables {
            trace.finish()?;
            timing.finish()?;
        }
        // The warnings at the start have it for an adapter that was not reconnected.
        let reconnected = (outcome.link.resumes > 0).then(|| device.device.connection.long_latency_timer());
        if let Some(warning) = reconnected.flatten() {
            error_line(format_args!("lashloop: warning: since the reconnect {warning}"));
        }
        let departure =
            gate.map(|it| gate::check(&scenario, &it.recorded, &it.intervals)).transpose()?.flatten();
        if departure.is_some() {
            outcome.judgement.cap(Some(Verdict::Invalid));
        }
        let summary = summary(&scenario, &device.device, &outcome);
        // Closes the link, and with it the sending end of the capture.
        drop(device);
        if let Some(capture) = capture {
            capture.finish()?;
        }
        if let Some(folder) = &self.out {
            summary.write(&folder.join(SUMMARY_FILE))?;
        }
        // A signal before this point would truncate the record.
        drop(signals);
        if let Some(departure) = departure {
            outln!("GATE   {departure}");
        }
        run_report::print(&scenario, &summary, &outcome);
        Ok(summary.verdict.into())
    }
}

/// What the gate compares after the run.
struct Gate {
    recorded: RecordedMotion,
    intervals: Intervals,
}

impl Gate {
    /// `file` has the intervals; without one the model has none.
    fn read(file: Option<&Path>) -> Result<Self, CliError> {
        let input = |path: &Path| {
            gate::intervals(path).map_err(|source| CliError::Input { path: path.to_owned(), source })
        };
        let intervals = file.map(input).transpose()?.unwrap_or_default();
        Ok(Self { recorded: RecordedMotion::default(), intervals })
    }
}

/// The folder of the record.
#[derive(Clone, Copy)]
struct Folder<'a> {
    path: &'a Path,
    flush_rows: u32,
}

impl<'a> Folder<'a> {
    fn prepare(path: &'a Path, scenario: &Scenario) -> Result<Self, CliError> {
        prepare_folder(path, &[])?;
        Ok(Self { path, flush_rows: scenario.record.flush_rows })
    }
}

struct Tables {
    trace: TraceWriter,
    timing: TimingWriter,
    steps: u64,
}

pub(super) fn summary(scenario: &Scenario, device: &Device, outcome: &Outcome) -> Summary {
    Summary {
        verdict: outcome.judgement.verdict,
        scenario: scenario.name.clone(),
        device: device.description(),
        evidence: device.evidence(),
        mode: scenario.run.mode,
        controller: scenario.controller.name.clone(),
        telemetry: Telemetry::from(device.session.subscription()),
        seed: scenario.run.seed,
        end: outcome.end.to_string(),
        broken_rule: outcome.end.broken_rule(),
        steps: outcome.steps,
        simulated_s: outcome.simulated_s,
        wall_s: outcome.wall_s,
        metrics: outcome.metrics.clone(),
        expectations: outcome.judgement.expectations.clone(),
        link: outcome.link,
        timing: outcome.timing.clone(),
        faults: outcome.faults.clone(),
        torque_sha256: outcome.torque_sha256.clone(),
        versions: Versions::of(&device.session.identity),
    }
}

struct RunWatcher<'a> {
    record: Option<Folder<'a>>,
    /// Created at the start, when the signals are known.
    tables: Option<Tables>,
    capture: Option<Capture>,
    supervisor: &'a Supervisor,
    progress: Progress,
    gate: Option<Gate>,
}

impl StepObserver for RunWatcher<'_> {
    fn begin(&mut self, signals: &SignalTable) -> Result<(), WriteError> {
        let Some(Folder { path, flush_rows }) = self.record else { return Ok(()) };
        // Only now: a run that the drive refuses keeps the old record whole.
        remove_if_present(&path.join(SUMMARY_FILE))?;
        self.tables = Some(Tables {
            trace: TraceWriter::create(path, signals, flush_rows)?,
            timing: TimingWriter::create(path, flush_rows)?,
            steps: 0,
        });
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.progress.step();
        if let Some(gate) = &mut self.gate {
            gate.recorded.push(step);
        }
        if let Some(capture) = &self.capture {
            capture.check()?;
        }
        let Some(Tables { trace, timing, steps }) = &mut self.tables else { return Ok(()) };
        trace.push(step.trace())?;
        timing.push(&TimingRow::new(*steps, &step.timing))?;
        *steps += 1;
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.supervisor.interrupted()
    }
}
