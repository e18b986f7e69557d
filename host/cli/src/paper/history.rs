//! One run for a figure: its trace in memory, with a progress bar.

use lashloop::execution::OpenDrive;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{RunStart, Step, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Verdict;
use lashloop_record::columns::Columns;
use lashloop_record::summary::Summary;
use lashloop_record::writer::RecordWriter;
use merzouki_2005::figures::Run;

use crate::error::CliError;
use crate::progress::Progress;

struct History {
    trace: Columns,
    shown_from_s: f64,
    progress: Progress,
}

impl StepObserver for History {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        self.trace.begin(start)
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.progress.step();
        if step.row.time_s >= self.shown_from_s {
            self.trace.step(step)?;
        }
        Ok(())
    }
}

/// Makes a run, keeps its trace from `shown_from_s` on, and writes its record.
pub(super) fn run_for_figure(
    drive: &mut OpenDrive<'_>,
    mut scenario: Scenario,
    shown_from_s: f64,
    supervisor: &Supervisor,
    mut record: Option<RecordWriter>,
) -> Result<(Run, Verdict), CliError> {
    let progress = Progress::of(&scenario);
    let mut history = History { trace: Columns::default(), shown_from_s, progress };
    let _signals = supervisor.guard_signals();
    let outcome = drive.run(&mut scenario, vec![&mut history], record.as_mut())?;
    if let Some(record) = record {
        record.finish(&Summary::new(&scenario, drive.device(), &outcome))?;
    }
    Ok((Run { trace: history.trace, metrics: outcome.metrics }, outcome.judgement.verdict))
}
