//! Device time, supplied by the drive's owner.

use core::time::Duration;

/// A monotonic clock.
pub trait Clock {
    /// Time since boot, with a resolution of 0.1 us or better where the hardware has one.
    fn now(&self) -> Duration;
}

/// A clock that moves only when its owner sets or advances it. By default it is at zero, the instant of boot.
#[derive(Clone, Copy, Debug, Default)]
pub struct ManualClock {
    now: Duration,
}

impl ManualClock {
    /// Sets the time since boot. [`Clock`] is monotonic: an earlier time leaves the clock unchanged.
    pub fn set(&mut self, now: Duration) {
        self.now = self.now.max(now);
    }

    /// Moves the clock forward. Device time saturates at its largest value.
    pub fn advance(&mut self, elapsed: Duration) {
        self.now = self.now.saturating_add(elapsed);
    }
}

impl Clock for ManualClock {
    fn now(&self) -> Duration {
        self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn manual_clock_moves_forward_only() {
        let mut clock = ManualClock::default();
        clock.advance(Duration::from_millis(3));
        clock.set(Duration::from_millis(5));
        clock.set(Duration::from_millis(4));
        assert_eq!(clock.now(), Duration::from_millis(5));
    }
}
