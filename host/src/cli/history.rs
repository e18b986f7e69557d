//! One run for a figure: its trace in memory, with a progress bar.

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::record::trace::TraceRow;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, Step, StepObserver};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::supervisor::Supervisor;
use lashloop_bench::verdict::Verdict;
use lashloop_report::paper::Run;

use super::error::CliError;
use super::progress::Progress;

struct History<'a> {
    rows: Vec<TraceRow>,
    shown_from_s: f64,
    progress: Progress,
    supervisor: &'a Supervisor,
}

impl StepObserver for History<'_> {
    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.progress.step();
        if step.row.time_s >= self.shown_from_s {
            self.rows.push(step.row);
        }
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.supervisor.interrupted()
    }
}

/// Runs a scenario in lockstep and keeps the rows from `shown_from_s` on.
pub(super) fn run_for_figure(
    scenario: &Scenario,
    shown_from_s: f64,
    device: &mut DeviceUnderTest,
    supervisor: &Supervisor,
) -> Result<(Run, Verdict), CliError> {
    let progress = Progress::of(scenario);
    let mut history = History { rows: Vec::new(), shown_from_s, progress, supervisor };
    let _signals = supervisor.guard_signals();
    let outcome = run::run(scenario, device, Clock::Lockstep, &mut history)?;
    Ok((Run { rows: history.rows, metrics: outcome.metrics }, outcome.judgement.verdict))
}
