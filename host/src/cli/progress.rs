//! A progress bar on a terminal, and no output elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Step, StepObserver};
use lashloop_bench::scenario::Scenario;

/// Steps between two updates of the bar: a run makes tens of thousands per second.
const STRIDE: u64 = 250;

pub(super) struct Progress {
    bar: ProgressBar,
    steps: u64,
}

impl Progress {
    pub(super) fn of(scenario: &Scenario) -> Self {
        Self::over(scenario.title.clone(), scenario.run.steps().into())
    }

    /// A bar over `total` units of work.
    pub(super) fn over(message: String, total: u64) -> Self {
        let bar = ProgressBar::new(total);
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3}% {eta:>4}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(message);
        Self { bar, steps: 0 }
    }

    /// Shows `done` units of work.
    pub(super) fn show(&self, done: u64) {
        self.bar.set_position(done);
    }

    pub(super) fn step(&mut self) {
        self.steps += 1;
        if self.steps.is_multiple_of(STRIDE) {
            self.bar.set_position(self.steps);
        }
    }
}

impl StepObserver for Progress {
    fn step(&mut self, _: &Step) -> Result<(), WriteError> {
        Progress::step(self);
        Ok(())
    }
}

impl Drop for Progress {
    /// Clears the bar, so that none remains above the error of a failed run.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
