//! Wakes the loop at absolute times.

use std::hint;
use std::io;
use std::time::{Duration, Instant};

use rustix::io::Errno;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};

/// A grid of due times, one per period.
pub(super) struct Pacer {
    epoch: Instant,
    /// `epoch` as the system counts it: [`Instant`] is the monotonic clock but does not give its value.
    epoch_on_clock: Duration,
    period: Duration,
    spin: Duration,
}

impl Pacer {
    /// Starts now: step 0 is due.
    pub(super) fn start(period: Duration, spin: Duration) -> Self {
        let (epoch, epoch_on_clock) = now_on_both_clocks();
        Self { epoch, epoch_on_clock, period, spin }
    }

    /// When a step is due.
    pub(super) fn due(&self, step: u32) -> Instant {
        self.epoch + self.period * step
    }

    /// The step whose period contains an instant.
    pub(super) fn step_at(&self, at: Instant) -> u32 {
        let periods = at.saturating_duration_since(self.epoch).as_nanos() / self.period.as_nanos();
        u32::try_from(periods).unwrap_or(u32::MAX)
    }

    /// Waits until `due` and returns the time after that; at once if it has passed.
    ///
    /// # Errors
    /// The system can't sleep.
    pub(super) fn wait_for(&self, due: Instant) -> io::Result<Instant> {
        let wake = (due - self.epoch).saturating_sub(self.spin) + self.epoch_on_clock;
        let wake = Timespec { tv_sec: wake.as_secs() as i64, tv_nsec: wake.subsec_nanos().into() };
        if Instant::now() + self.spin < due {
            loop {
                match clock_nanosleep_absolute(ClockId::Monotonic, &wake) {
                    Ok(()) => break,
                    Err(Errno::INTR) => {}
                    Err(error) => return Err(error.into()),
                }
            }
        }
        loop {
            let now = Instant::now();
            if now >= due {
                return Ok(now);
            }
            hint::spin_loop();
        }
    }
}

/// Now, on both clocks. Read again after an interruption: every step would be early or late by the difference.
fn now_on_both_clocks() -> (Instant, Duration) {
    const CLOSE: Duration = Duration::from_micros(5);
    loop {
        let before = Instant::now();
        let now = clock_gettime(ClockId::Monotonic);
        if before.elapsed() < CLOSE {
            return (before, Duration::new(now.tv_sec as u64, now.tv_nsec as u32));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: Duration = Duration::from_millis(1);

    #[test]
    fn steps_are_due_on_a_grid_that_lateness_does_not_move() {
        let pacer = Pacer::start(PERIOD, Duration::ZERO);
        std::thread::sleep(3 * PERIOD);
        assert_eq!(pacer.due(1_000_000) - pacer.due(0), 1_000_000 * PERIOD);
    }

    #[test]
    fn no_step_begins_early() {
        for spin in [Duration::ZERO, PERIOD / 4, 10 * PERIOD] {
            let pacer = Pacer::start(PERIOD, spin);
            for step in 1..20 {
                assert!(pacer.wait_for(pacer.due(step)).expect("a clock") >= pacer.due(step));
            }
        }
    }

    #[test]
    fn a_due_time_in_the_past_is_not_waited_for() {
        let pacer = Pacer::start(PERIOD, Duration::ZERO);
        std::thread::sleep(5 * PERIOD);
        let woke = pacer.wait_for(pacer.due(1)).expect("a clock");
        assert!(pacer.step_at(woke) >= 5);
    }

    #[test]
    fn an_instant_is_in_the_period_of_the_step_due_last() {
        let pacer = Pacer::start(PERIOD, Duration::ZERO);
        assert_eq!(pacer.step_at(pacer.due(7)), 7);
        assert_eq!(pacer.step_at(pacer.due(8) - Duration::from_nanos(1)), 7);
    }
}
