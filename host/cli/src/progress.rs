//! Progress on standard error: a bar on a terminal, plain lines elsewhere.

use std::io::{self, IsTerminal as _};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use lashloop_bench::number::Shown;
use lashloop_bench::scenario::Scenario;

use super::colour::{self, Stream};
use super::output::error_line;
use lashloop_live::SoFar;
use lashloop_session::printable;

/// Steps between two updates of the bar: a run makes tens of thousands per second.
const STRIDE: u64 = 250;
/// A shorter run shows no progress.
const SILENCE: Duration = Duration::from_secs(1);
/// Time between two updates of the bar of a run, and between two plain lines.
const BAR_INTERVAL: Duration = Duration::from_millis(250);
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// A bar over units of work, and no output elsewhere.
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
        bar.set_message(printable(&message));
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

impl Drop for Progress {
    /// Clears the bar, so that none remains above the error of a failed run.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// The progress of one run: its time, its rate and its verdict so far.
pub(super) struct RunProgress {
    /// On a terminal.
    bar: Option<ProgressBar>,
    duration_s: f64,
    next: Option<Instant>,
}

impl RunProgress {
    pub(super) fn new(scenario: &Scenario) -> Self {
        let bar = io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::hidden();
            let style = ProgressStyle::with_template("{bar:24} {percent:>3}% {wide_msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_length(scenario.run.steps().into());
            bar
        });
        Self { bar, duration_s: scenario.run.duration_s, next: None }
    }

    /// Whether it is time for the next update. The run began at the first call.
    pub(super) fn is_due(&mut self, now: Instant) -> bool {
        let (first, interval) = match &self.bar {
            Some(_) => (SILENCE, BAR_INTERVAL),
            None => (LINE_INTERVAL, LINE_INTERVAL),
        };
        let next = *self.next.get_or_insert(now + first);
        let is_due = now >= next;
        if is_due {
            self.next = Some(now + interval);
        }
        is_due
    }

    /// Shows the progress. `rate` is simulated time per wall-clock time.
    pub(super) fn show(&self, steps: u64, simulated_s: f64, rate: f64, so_far: &SoFar) {
        let verdict = so_far.decided().map_or_else(String::new, |verdict| {
            let shown = match &self.bar {
                Some(_) => colour::of_verdict(verdict, &verdict.to_string(), Stream::Error),
                None => verdict.to_string(),
            };
            format!("{shown}: ")
        });
        let time = format!("{simulated_s:.1} s of {} s", Shown(self.duration_s));
        let text = format!("{time}, {} times real time; {verdict}{so_far}", shown_rate(rate));
        match &self.bar {
            Some(bar) => {
                if bar.is_hidden() {
                    bar.set_draw_target(indicatif::ProgressDrawTarget::stderr());
                }
                bar.set_position(steps);
                bar.set_message(text);
            }
            None => error_line(format_args!("progress    {text}")),
        }
    }
}

/// Two significant digits.
fn shown_rate(rate: f64) -> String {
    match rate {
        rate if rate < 10.0 => format!("{rate:.1}"),
        rate => format!("{rate:.0}"),
    }
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_every_few_seconds_and_none_for_a_short_run() {
        let mut progress = RunProgress { bar: None, duration_s: 25.0, next: None };
        let start = Instant::now();
        let due: Vec<u64> = (0..=12_000_u64)
            .step_by(50)
            .filter(|ms| progress.is_due(start + Duration::from_millis(*ms)))
            .collect();
        assert_eq!(due, [5_000, 10_000]);
    }

    #[test]
    fn a_bar_begins_after_a_second() {
        let mut progress = RunProgress { bar: Some(ProgressBar::hidden()), duration_s: 25.0, next: None };
        let start = Instant::now();
        let is_due_at = |ms| start + Duration::from_millis(ms);
        assert!(!progress.is_due(start) && !progress.is_due(is_due_at(999)));
        assert!(progress.is_due(is_due_at(1_000)) && !progress.is_due(is_due_at(1_200)));
    }
}
