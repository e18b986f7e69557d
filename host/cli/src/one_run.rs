//! One run as the command line makes it: a person watches it, and it may be captured, recorded and held against its plant model.

use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Clock, Step, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::timing::ClockName;
use lashloop_decode::capture::link::Captured;
use lashloop_decode::capture::{self, Capture, WhenFull};
use lashloop_link::Link;
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;

use super::error::CliError;
use super::output::{warn, write_csv};
use super::supervision::start_supervisor;
use super::watch_options::WatchOptions;
use lashloop::execution::{Execution, Finished, Middleware, Place};
use lashloop_hardware::identify::gate::{self, Intervals, RecordedMotion};

/// A run to be made.
pub(super) struct OneRun<'a> {
    pub(super) scenario: Scenario,
    /// What its record keeps of its origin.
    pub(super) source: RunSource,
    pub(super) place: Place<'a>,
    pub(super) clock: Clock,
    /// Folder of its record.
    pub(super) folder: Option<RecordFolder>,
    /// Whether the record has its tables as CSV at once.
    pub(super) csv: bool,
    pub(super) watch: &'a WatchOptions,
    /// File for every frame on the line.
    pub(super) capture: Option<&'a Path>,
    pub(super) gate: Option<Gate>,
}

impl OneRun<'_> {
    /// Makes the run and writes its record. Prints warnings only.
    pub(super) fn make(self) -> Result<Finished, CliError> {
        let Self { scenario, source, place, clock, folder, csv, watch, capture, mut gate } = self;
        let when_full = match clock.name() {
            ClockName::Lockstep => WhenFull::Wait,
            ClockName::RealTime => WhenFull::Fail,
        };
        let out = folder.as_ref().map(|folder| folder.path().to_owned());
        let (recorder, capture) = capture.map(|path| capture::create(path, when_full)).transpose()?.unzip();
        let watch = watch.start()?;
        let supervisor = start_supervisor()?;
        let shown = scenario.clone();
        let (mut monitor, mut capture) = (watch.monitor(&shown), CaptureWatch(capture));
        let listen = recorder.map(|recorder| -> Middleware<'_> {
            Box::new(|link| Box::new(Captured::new(link, recorder)) as Box<dyn Link>)
        });
        let record = folder.map(|folder| RecordWriter::new(folder, source));
        let mut execution = Execution::new(scenario, place).clock(clock).middleware(listen).record(record);
        execution = execution.watch(&mut monitor).watch(&mut capture);
        if let Some(gate) = &mut gate {
            execution = execution.watch(gate);
        }
        let ready = execution.open(&supervisor)?;
        for warning in ready.device().warnings() {
            warn(format_args!("{warning}"));
        }
        let signals = supervisor.guard_signals();
        watch.wait(|| supervisor.interrupted());
        let mut made = ready.run()?;
        drop(monitor);
        // The warnings at the start have it for an adapter that was not reconnected.
        let reconnected =
            (made.outcome.link.resumes > 0).then(|| made.device().connection.long_latency_timer());
        if let Some(warning) = reconnected.flatten() {
            warn(format_args!("since the reconnect {warning}"));
        }
        let departure = gate.map(|it| gate::check(&made.scenario, &it.recorded, &it.intervals)).transpose();
        match &departure {
            Ok(None | Some(None)) => {}
            Ok(Some(Some(departure))) => made.outcome.judgement.close_gate(departure.to_string()),
            // An evaluation error fails the gate.
            Err(error) => made.outcome.judgement.close_gate(error.to_string()),
        }
        // Closes the link, and with it the sending end of the capture.
        let finished = made.finish();
        let captured = capture.0.map_or(Ok(0), |capture| capture.finish());
        // Before any other error: the run is complete, and so is its record.
        let finished = finished?;
        captured?;
        departure?;
        watch.finish(&finished.outcome, out.as_deref());
        if let Some(folder) = &out {
            write_csv(folder, csv);
        }
        // A signal before this point would truncate the record.
        drop(signals);
        Ok(finished)
    }
}

/// What the gate compares after the run.
pub(super) struct Gate {
    recorded: RecordedMotion,
    intervals: Intervals,
}

impl Gate {
    /// `file` has the intervals; without one the model has none.
    pub(super) fn read(file: Option<&Path>) -> Result<Self, CliError> {
        let input = |path: &Path| {
            gate::intervals(path).map_err(|source| CliError::Input { path: path.to_owned(), source })
        };
        let intervals = file.map(input).transpose()?.unwrap_or_default();
        Ok(Self { recorded: RecordedMotion::default(), intervals })
    }
}

impl StepObserver for Gate {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.recorded.push(step);
        Ok(())
    }
}

/// Ends the run when its capture can't be written.
struct CaptureWatch(Option<Capture>);

impl StepObserver for CaptureWatch {
    fn step(&mut self, _: &Step) -> Result<(), WriteError> {
        self.0.as_ref().map_or(Ok(()), Capture::check)
    }
}
