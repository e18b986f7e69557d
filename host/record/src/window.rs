//! The record of a window: the steps around the longest silence of the drive, or the last ones if it was never silent.
//!
//! For runs that are repeated for hours: nothing is on the disk before a run has failed, and then its window alone.

use std::collections::VecDeque;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::run::{Event, RunError, RunStart, Step, StepObserver};
use lashloop_bench::timing::StepOutcome;

use crate::failure::Failure;
use crate::folder::RecordFolder;
use crate::samples::SampleWriter;
use crate::source::RunSource;
use crate::summary::Summary;
use crate::writer::{Beginning, finish};

/// Keeps the steps of a window in memory.
pub struct WindowRecorder {
    source: RunSource,
    beginning: Option<Beginning>,
    ring: Ring<Step>,
    /// Events of the whole run, the latest ones.
    events: VecDeque<(u32, Event)>,
    around_s: f64,
    failure: Option<Failure>,
}

/// A drive may log without end.
const MAX_EVENTS: usize = 1000;

impl WindowRecorder {
    /// A window of `around_s` before and after.
    #[must_use]
    pub fn new(around_s: f64, source: RunSource) -> Self {
        Self { source, beginning: None, ring: Ring::new(0), events: VecDeque::new(), around_s, failure: None }
    }

    /// Whether the run has begun. Before it, there is nothing to write.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.beginning.is_some()
    }

    /// Writes the window to a folder; without a summary for a run that has none.
    ///
    /// # Errors
    /// A file can't be written.
    pub fn write(self, folder: &RecordFolder, summary: Option<&Summary>) -> Result<(), WriteError> {
        let Some(beginning) = self.beginning else { return Ok(()) };
        let (first_step, steps) = self.ring.window();
        let mut samples = beginning.write(folder, first_step)?;
        let push = |samples: &mut SampleWriter| {
            let mut events = self.events.iter().peekable();
            for (number, step) in (first_step..).zip(&steps) {
                while let Some((at, event)) = events.next_if(|(at, _)| u64::from(*at) <= number) {
                    samples.push_event(*at, event);
                }
                samples.push(step)?;
            }
            events.for_each(|(at, event)| samples.push_event(*at, event));
            Ok(())
        };
        push(&mut samples).map_err(|error| folder.named(error))?;
        self.failure.map_or(Ok(()), |failure| failure.write(folder.path()))?;
        summary.map_or(Ok(()), |summary| finish(samples, folder, summary))
    }
}

impl StepObserver for WindowRecorder {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        self.ring = Ring::new((self.around_s / start.scenario.run.control_period_s()).ceil() as usize);
        self.beginning = Some(Beginning::new(start, &self.source));
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.ring.push(step.clone(), step.timing.outcome != StepOutcome::Answered);
        Ok(())
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        self.events.push_back((step, event.clone()));
        if self.events.len() > MAX_EVENTS {
            self.events.pop_front();
        }
        Ok(())
    }

    fn failed(&mut self, error: &RunError) {
        self.failure = Some(Failure { error: error.to_string() });
    }
}

/// The latest items, and those around the longest run of triggers.
#[derive(Debug)]
struct Ring<T> {
    around: usize,
    /// As many items as the window has before a run, and the present run.
    latest: VecDeque<T>,
    pushed: u64,
    /// Length of the present run of triggers.
    run: usize,
    /// Whether it is the longest.
    is_longest: bool,
    longest: usize,
    /// The window around the longest run, its first item's number, and the items that it still takes.
    around_longest: VecDeque<T>,
    first: u64,
    open: usize,
}

impl<T: Clone> Ring<T> {
    fn new(around: usize) -> Self {
        Self {
            around,
            latest: VecDeque::new(),
            pushed: 0,
            run: 0,
            is_longest: false,
            longest: 0,
            around_longest: VecDeque::new(),
            first: 0,
            open: 0,
        }
    }

    fn push(&mut self, item: T, is_trigger: bool) {
        self.run = if is_trigger { self.run + 1 } else { 0 };
        let is_longest = self.run > self.longest;
        if is_longest {
            if !self.is_longest {
                self.first = self.pushed - self.latest.len() as u64;
                self.around_longest = self.latest.clone();
            }
            self.longest = self.run;
            self.open = self.around + 1;
        }
        self.is_longest = is_longest;
        if self.open > 0 {
            self.open -= 1;
            self.around_longest.push_back(item.clone());
        }
        self.latest.push_back(item);
        let surplus = self.latest.len().saturating_sub(self.around + self.run);
        self.latest.drain(..surplus);
        self.pushed += 1;
    }

    /// The number of the first item, and the items.
    fn window(self) -> (u64, VecDeque<T>) {
        if self.longest > 0 {
            (self.first, self.around_longest)
        } else {
            (self.pushed - self.latest.len() as u64, self.latest)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Ring;

    /// The numbers that a ring of 3 has kept of items from 0, and the number of the first.
    fn kept(count: u32, triggers: &[u32]) -> (u64, Vec<u32>) {
        let mut ring = Ring::new(3);
        (0..count).for_each(|item| ring.push(item, triggers.contains(&item)));
        let (first, items) = ring.window();
        (first, items.into())
    }

    #[test]
    fn a_window_without_a_trigger_is_the_last_items() {
        assert_eq!(kept(10, &[]), (7, vec![7, 8, 9]));
        assert_eq!(kept(2, &[]), (0, vec![0, 1]));
    }

    #[test]
    fn a_window_has_items_before_and_after_the_longest_run_of_triggers() {
        assert_eq!(kept(20, &[9]), (6, (6..=12).collect()));
        assert_eq!(kept(20, &[9, 10]), (6, (6..=13).collect()));
        assert_eq!(kept(30, &[5, 15, 16, 25]), (12, (12..=19).collect()));
        assert_eq!(
            kept(30, &[4, 5, 6, 7, 15, 16, 17, 18, 19]),
            (12, (12..=22).collect()),
            "both exceed the time around"
        );
        assert_eq!(
            kept(30, &[10, 11, 13, 14, 15]),
            (10, (10..=18).collect()),
            "a window may hold an earlier run"
        );
        assert_eq!(kept(10, &[0, 9]), (0, vec![0, 1, 2, 3]));
        assert_eq!(kept(10, &[9]), (6, vec![6, 7, 8, 9]), "the run has ended");
    }
}
