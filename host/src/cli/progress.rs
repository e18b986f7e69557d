//! A progress bar on a terminal; nothing anywhere else.

use indicatif::{ProgressBar, ProgressStyle};
use lashloop::scenario::Scenario;

/// Steps between two movements of the bar: a run makes tens of thousands in a second.
const STRIDE: u64 = 250;

pub(super) struct Progress {
    bar: ProgressBar,
    steps: u64,
}

impl Progress {
    pub(super) fn of(scenario: &Scenario) -> Self {
        let bar = ProgressBar::new(scenario.run.steps().into());
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3}% {eta:>4}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(scenario.title.clone());
        Self { bar, steps: 0 }
    }

    pub(super) fn step(&mut self) {
        self.steps += 1;
        if self.steps.is_multiple_of(STRIDE) {
            self.bar.set_position(self.steps);
        }
    }
}

impl Drop for Progress {
    /// A run that fails leaves no half bar above its error.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
