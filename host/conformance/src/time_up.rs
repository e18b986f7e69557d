//! The end of the time for a check.

use lashloop_session::line::Line;

use crate::prelude::wire::*;

/// When the time for a check ends, and what to report then. Time for which the drive's program has waited for a core doesn't
/// count.
pub(super) struct TimeUp {
    pub(super) at: Instant,
    pub(super) cause: String,
    pub(super) starvation: Starvation,
}

/// How long the drive's program had waited for a core at a look.
#[derive(Clone, Copy)]
pub(super) struct Starvation {
    seen_at: Instant,
    starved: Duration,
}

impl Starvation {
    pub(super) fn look(line: &mut Line) -> Self {
        Self { seen_at: line.now(), starved: line.starved() }
    }

    /// The wait from this look to a later one: of several threads at most the time that has passed.
    pub(super) fn until(self, later: Self) -> Duration {
        let passed = later.seen_at.saturating_duration_since(self.seen_at);
        later.starved.saturating_sub(self.starved).min(passed)
    }
}

impl TimeUp {
    /// Whether the time is up.
    pub(super) fn has_come(&mut self, line: &mut Line) -> bool {
        if line.now() < self.at {
            return false;
        }
        let now = Starvation::look(line);
        self.at += self.starvation.until(now);
        self.starvation = now;
        line.now() >= self.at
    }
}
