//! The end of the time for a check.

use std::time::{Duration, Instant};

use lashloop_session::line::Line;

/// When the time for a check ends, and what to report then. Time for which the drive's program has waited for a core doesn't
/// count.
pub(super) struct TimeUp {
    pub(super) at: Instant,
    pub(super) cause: &'static str,
    /// Time for which the program has waited at the last look.
    pub(super) starved: Duration,
}

impl TimeUp {
    /// Whether the time is up.
    pub(super) fn has_come(&mut self, line: &mut Line) -> bool {
        if line.now() < self.at {
            return false;
        }
        let starved = line.starved();
        self.at += starved.saturating_sub(self.starved);
        self.starved = starved;
        line.now() >= self.at
    }
}
