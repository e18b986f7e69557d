//! Wakes the loop at absolute times.

use std::hint;
use std::io;
use std::time::{Duration, Instant};

use lashloop_session::SessionError;
use lashloop_session::line::Line;
use rustix::io::Errno;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};

/// A clock that paces a loop.
pub(super) trait PacingClock {
    type Error;

    fn now(&mut self) -> Instant;

    /// Sleeps until an instant in the future.
    fn sleep_until(&mut self, until: Instant) -> Result<(), Self::Error>;
}

/// The wall clock.
pub(super) struct WallClock {
    anchor: Instant,
    /// `anchor` as the system counts it: [`Instant`] is the monotonic clock but does not give its value.
    anchor_on_clock: Duration,
}

impl WallClock {
    pub(super) fn new() -> Self {
        let (anchor, anchor_on_clock) = now_on_both_clocks();
        Self { anchor, anchor_on_clock }
    }
}

impl PacingClock for WallClock {
    type Error = io::Error;

    fn now(&mut self) -> Instant {
        Instant::now()
    }

    fn sleep_until(&mut self, until: Instant) -> io::Result<()> {
        let wake = until.saturating_duration_since(self.anchor) + self.anchor_on_clock;
        let wake = Timespec { tv_sec: wake.as_secs() as i64, tv_nsec: wake.subsec_nanos().into() };
        loop {
            match clock_nanosleep_absolute(ClockId::Monotonic, &wake) {
                Ok(()) => return Ok(()),
                Err(Errno::INTR) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }
}

/// The link's clock.
impl PacingClock for Line {
    type Error = SessionError;

    fn now(&mut self) -> Instant {
        Self::now(self)
    }

    fn sleep_until(&mut self, until: Instant) -> Result<(), SessionError> {
        self.wait_until(until)
    }
}

/// A grid of due times, one per period.
pub(super) struct Pacer {
    epoch: Instant,
    period: Duration,
    spin: Duration,
}

impl Pacer {
    /// Starts at `epoch`: step 0 is due.
    pub(super) fn start(epoch: Instant, period: Duration, spin: Duration) -> Self {
        Self { epoch, period, spin }
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
    /// The clock can't sleep.
    pub(super) fn wait_for<C: PacingClock>(&self, due: Instant, clock: &mut C) -> Result<Instant, C::Error> {
        if clock.now() + self.spin < due {
            clock.sleep_until((due - self.spin).max(self.epoch))?;
        }
        loop {
            let now = clock.now();
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
    use std::convert::Infallible;

    use super::*;

    const PERIOD: Duration = Duration::from_millis(1);

    /// A clock that moves by a microsecond when it is read, and past the end of each sleep by `oversleeps`.
    struct Scripted {
        now: Instant,
        oversleeps: Duration,
        slept: Vec<Instant>,
    }

    impl Scripted {
        fn new(oversleeps: Duration) -> Self {
            Self { now: Instant::now(), oversleeps, slept: Vec::new() }
        }
    }

    impl PacingClock for Scripted {
        type Error = Infallible;

        fn now(&mut self) -> Instant {
            self.now += Duration::from_micros(1);
            self.now
        }

        fn sleep_until(&mut self, until: Instant) -> Result<(), Infallible> {
            assert!(until > self.now, "a sleep has an end in the future");
            self.slept.push(until);
            self.now = until + self.oversleeps;
            Ok(())
        }
    }

    #[test]
    fn steps_are_due_on_a_grid_that_lateness_does_not_move() {
        let mut clock = Scripted::new(3 * PERIOD / 4);
        let pacer = Pacer::start(clock.now, PERIOD, Duration::ZERO);
        for step in 1..20 {
            let woke = pacer.wait_for(pacer.due(step), &mut clock).expect("a clock");
            assert_eq!(pacer.step_at(woke), step);
        }
        assert_eq!(clock.slept, (1..20).map(|step| pacer.epoch + PERIOD * step).collect::<Vec<_>>());
        assert_eq!(pacer.due(1_000_000) - pacer.due(0), 1_000_000 * PERIOD);
    }

    #[test]
    fn the_end_of_a_wait_is_polled_for_and_no_step_begins_early() {
        for spin in [Duration::ZERO, PERIOD / 4] {
            let mut clock = Scripted::new(Duration::ZERO);
            let pacer = Pacer::start(clock.now, PERIOD, spin);
            for step in 1..20 {
                let woke = pacer.wait_for(pacer.due(step), &mut clock).expect("a clock");
                assert!(woke >= pacer.due(step) && woke < pacer.due(step) + PERIOD / 100);
                assert_eq!(clock.slept.last(), Some(&(pacer.due(step) - spin)));
            }
        }
    }

    #[test]
    fn a_loop_that_polls_for_longer_than_a_period_never_sleeps() {
        let mut clock = Scripted::new(Duration::ZERO);
        let pacer = Pacer::start(clock.now, PERIOD, 10 * PERIOD);
        for step in 1..10 {
            assert!(pacer.wait_for(pacer.due(step), &mut clock).expect("a clock") >= pacer.due(step));
        }
        assert!(clock.slept.is_empty());
    }

    #[test]
    fn a_due_time_in_the_past_is_not_waited_for() {
        let mut clock = Scripted::new(5 * PERIOD);
        let pacer = Pacer::start(clock.now, PERIOD, Duration::ZERO);
        let woke = pacer.wait_for(pacer.due(1), &mut clock).expect("a clock");
        assert_eq!(pacer.step_at(woke), 6);
        let at_once = pacer.wait_for(pacer.due(2), &mut clock).expect("a clock");
        assert!(at_once - woke < PERIOD / 100);
        assert_eq!(clock.slept.len(), 1);
    }

    #[test]
    fn the_wall_clock_never_wakes_early() {
        let mut clock = WallClock::new();
        let until = Instant::now() + PERIOD;
        clock.sleep_until(until).expect("a clock");
        assert!(clock.now() >= until);
        clock.sleep_until(until).expect("a time in the past is over at once");
    }

    #[test]
    fn an_instant_is_in_the_period_of_the_step_due_last() {
        let pacer = Pacer::start(Instant::now(), PERIOD, Duration::ZERO);
        assert_eq!(pacer.step_at(pacer.due(7)), 7);
        assert_eq!(pacer.step_at(pacer.due(8) - Duration::from_nanos(1)), 7);
    }
}
