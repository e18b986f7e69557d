//! Device time, given by whoever owns the drive.

use core::time::Duration;

/// A monotonic clock.
pub trait Clock {
    /// Time since boot, to 0.1 us or better where the hardware can.
    fn now(&self) -> Duration;
}

/// A clock that stands still: for tests and for in-process runs, in which no device time passes.
#[derive(Clone, Copy, Debug, Default)]
pub struct ManualClock(
    /// What it shows.
    pub Duration,
);

impl Clock for ManualClock {
    fn now(&self) -> Duration {
        self.0
    }
}
