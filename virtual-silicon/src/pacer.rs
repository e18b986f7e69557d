//! Device time against the wall clock.
//!
//! Device time never runs ahead of the wall clock, or the drive's watchdog would time out on a host that is in time. It
//! may lag behind: where the emulation is slower than the silicon, device time waits for it, so a slow machine trips no
//! watchdog either. A wait that lasts too long is made up for, but not one that the machine or a signal has stopped.

use std::time::{Duration, Instant};

/// Most that a wait may last too long to be made up for: more than the system's usual delays, less than a watchdog.
const MOST_MADE_UP: Duration = Duration::from_millis(3);

/// The pace of device time.
#[derive(Debug)]
pub struct Pacer {
    /// Wall-clock and device time, at which device time was neither ahead nor behind.
    anchor: (Instant, Duration),
    /// The same at the end of the last wait.
    resumed: (Instant, Duration),
    /// End of the last wait as it was due.
    due: Instant,
}

impl Pacer {
    /// Both times start together.
    #[must_use]
    pub fn new(wall: Instant, device: Duration) -> Self {
        Self { anchor: (wall, device), resumed: (wall, device), due: wall }
    }

    /// Instant until which the device has to wait, which may be past. To be called before a wait, and followed by
    /// [`Self::resume`].
    #[must_use]
    pub fn due(&mut self, wall: Instant, device: Duration) -> Instant {
        let emulation = wall.saturating_duration_since(self.resumed.0);
        let emulated = device.saturating_sub(self.resumed.1);
        self.anchor.0 += emulation.saturating_sub(emulated);
        self.due = self.anchor.0 + device.saturating_sub(self.anchor.1);
        self.due
    }

    /// The wait is over.
    pub fn resume(&mut self, wall: Instant, device: Duration) {
        self.anchor.0 += wall.saturating_duration_since(self.due + MOST_MADE_UP);
        self.resumed = (wall, device);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn a_fast_emulation_waits_for_the_wall_clock() {
        let start = Instant::now();
        let mut pacer = Pacer::new(start, Duration::ZERO);
        assert_eq!(pacer.due(start + MS, 10 * MS), start + 10 * MS);
        pacer.resume(start + 10 * MS, 10 * MS);
        assert_eq!(pacer.due(start + 10 * MS, 11 * MS), start + 11 * MS);
    }

    #[test]
    fn a_slow_emulation_is_not_made_up_for() {
        let start = Instant::now();
        let mut pacer = Pacer::new(start, Duration::ZERO);
        assert_eq!(pacer.due(start + 50 * MS, 10 * MS), start + 50 * MS);
        pacer.resume(start + 50 * MS, 10 * MS);
        assert_eq!(pacer.due(start + 50 * MS, 11 * MS), start + 51 * MS);
    }

    #[test]
    fn a_wait_that_lasts_too_long_is_made_up_for() {
        let start = Instant::now();
        let mut pacer = Pacer::new(start, Duration::ZERO);
        let _ = pacer.due(start, MS);
        pacer.resume(start + 3 * MS, MS);
        assert_eq!(pacer.due(start + 3 * MS, 2 * MS), start + 2 * MS, "the next millisecond doesn't wait");
    }

    #[test]
    fn a_stopped_process_is_not_made_up_for() {
        let start = Instant::now();
        let mut pacer = Pacer::new(start, Duration::ZERO);
        let _ = pacer.due(start, MS);
        pacer.resume(start + 500 * MS, MS);
        assert_eq!(pacer.due(start + 500 * MS, 2 * MS), start + 498 * MS, "3 ms of it");
    }
}
