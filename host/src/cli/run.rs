//! `lashloop run`: one scenario on one device.

use std::path::{Path, PathBuf};

use crate::bench::Bench;
use clap::Args;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::capture::link::Captured;
use lashloop_bench::capture::{self, Capture, WhenFull};
use lashloop_bench::device::{Device, DeviceChoice};
use lashloop_bench::link::Link;
use lashloop_bench::run::DeviceUnderTest;
use lashloop_bench::run::{self, Observers, Outcome, Step, StepObserver, check_bench_mode};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::Exit;
use lashloop_record::summary::{Summary, Telemetry, Versions};
use lashloop_record::writer::RecordWriter;

use super::clock_options::ClockOptions;
use super::error::CliError;
use super::options::{RecordOptions, RigOption, ScenarioOptions};
use super::output::error_line;
use super::supervision::start_supervisor;
use super::watch_options::WatchOptions;
use super::{report_files, run_junit, run_report};
use crate::identify::gate::{self, Intervals, RecordedMotion};
use crate::rig::check::check_board;
use crate::suite::case_result::CaseResult;

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
}

impl Arguments {
    pub(crate) fn run(self, bench: &Bench) -> Result<Exit, CliError> {
        let junit = self.junit.clone();
        if let Some(path) = &junit {
            report_files::check(path, std::slice::from_ref(self.scenario.file()))?;
        }
        let page = self.record.out.clone().filter(|_| self.report);
        let Executed { scenario, summary, outcome } = self.execute(bench).inspect_err(|error| {
            junit.iter().for_each(|path| run_junit::write_error(path, error));
        })?;
        run_report::print(&scenario, &summary, &outcome);
        if let Some(path) = &junit {
            let result = CaseResult::of_run(&scenario.name, summary.device.clone(), &outcome);
            run_junit::write(path, &result)?;
        }
        // The run has its verdict, with or without its page.
        if let Some(folder) = page
            && let Err(error) = super::report::write(&folder)
        {
            error_line(format_args!("lashloop: warning: no page of the run: {error}"));
        }
        Ok(summary.verdict.into())
    }

    /// Makes the run and writes its record. Prints warnings only.
    pub(super) fn execute(self, bench: &Bench) -> Result<Executed, CliError> {
        let (mut scenario, mut source) = {
            let law = self.controller.map(Override::Controller);
            self.scenario.read_with_source(law.into_iter().chain(self.mode.map(Override::Mode)), bench)?
        };
        let clock = self.clock.clock()?;
        let when_full = match clock.name() {
            ClockName::Lockstep => WhenFull::Wait,
            ClockName::RealTime => WhenFull::Fail,
        };
        let rig = self.rig.take(bench, &format!("run {}", scenario.name))?;
        let choice = match &rig {
            Some(taken) => {
                source.rig = Some(taken.file.clone());
                taken.rig.allows(&scenario)?;
                taken.check_present()?;
                scenario.link.baud = taken.rig.port.baud;
                &taken.rig.port.device
            }
            None => &self.device,
        };
        let mut gate = self.gate.as_ref().map(|file| Gate::read(file.as_deref())).transpose()?;
        let folder = self.record.claim(Path::new(&scenario.name))?;
        self.junit.as_deref().map_or(Ok(()), run_junit::begin)?;
        let capture = self.capture.as_deref().map(|path| capture::create(path, when_full)).transpose()?;
        let (recorder, capture) = capture.unzip();
        let watch = self.watch.start()?;
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
        let mut monitor = watch.monitor(&scenario);
        let mut interrupt = Interrupt { supervisor: &supervisor, capture };
        let mut record = folder.map(|folder| RecordWriter::new(folder, source));
        let signals = supervisor.guard_signals();
        let mut observers: Vec<&mut dyn StepObserver> = vec![&mut monitor, &mut interrupt];
        observers.extend(gate.as_mut().map(|it| it as &mut dyn StepObserver));
        observers.extend(record.as_mut().map(|it| it as &mut dyn StepObserver));
        watch.wait(|| supervisor.interrupted());
        let mut outcome = run::run(&scenario, &mut device, clock, &mut Observers(observers))?;
        let Interrupt { capture, .. } = interrupt;
        drop(monitor);
        // The warnings at the start have it for an adapter that was not reconnected.
        let reconnected = (outcome.link.resumes > 0).then(|| device.device.connection.long_latency_timer());
        if let Some(warning) = reconnected.flatten() {
            error_line(format_args!("lashloop: warning: since the reconnect {warning}"));
        }
        let departure = gate.map(|it| gate::check(&scenario, &it.recorded, &it.intervals)).transpose();
        match &departure {
            Ok(None | Some(None)) => {}
            Ok(Some(Some(departure))) => outcome.judgement.close_gate(departure.to_string()),
            // A gate that can't be computed isn't passed.
            Err(error) => outcome.judgement.close_gate(error.to_string()),
        }
        let summary = summary(&scenario, &device.device, &outcome);
        // Closes the link, and with it the sending end of the capture.
        drop(device);
        let captured = capture.map_or(Ok(0), |capture| capture.finish());
        // Before any other error: the run is complete, and so is its record.
        if let Some(record) = record {
            record.finish(&summary)?;
        }
        captured?;
        departure?;
        watch.finish(&outcome, self.record.out.as_deref());
        // A signal before this point would truncate the record.
        drop(signals);
        Ok(Executed { scenario, summary, outcome })
    }
}

/// A run that was made and recorded.
pub(super) struct Executed {
    scenario: Scenario,
    summary: Summary,
    pub(super) outcome: Outcome,
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
        breaches: outcome.judgement.breaches.clone(),
        gate: outcome.judgement.gate.clone(),
        reasons: outcome.reasons(),
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

impl StepObserver for Gate {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.recorded.push(step);
        Ok(())
    }
}

/// What ends a run early: the user, or a capture that can't be written.
struct Interrupt<'a> {
    supervisor: &'a Supervisor,
    capture: Option<Capture>,
}

impl StepObserver for Interrupt<'_> {
    fn step(&mut self, _: &Step) -> Result<(), WriteError> {
        self.capture.as_ref().map_or(Ok(()), Capture::check)
    }

    fn stop_asked(&self) -> bool {
        self.supervisor.interrupted()
    }
}
