//! The baseline of a paced loop: a thread that sleeps until the next period. The loop's own histograms time it.

use std::hint;
use std::io;
use std::thread;
use std::time::Duration;

use lashloop_bench::run::real_time::{RealTime, obtain};
use lashloop_bench::timing::{ClockName, RoundTrip, StepOutcome, StepTiming, TimingReport, Timings};
use rustix::io::Errno;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{Timespec, clock_gettime};

/// Control period of both sides, which is that of the scenarios.
pub(super) const PERIOD: Duration = Duration::from_millis(1);
/// Steps at the start of a round that do not count.
pub(super) const WARM_UP: u32 = 100;
const PERIOD_NS: i64 = PERIOD.as_nanos() as i64;

/// Calls `work` once per period. `work` returns its round-trip time, or `None` if there is none to record.
///
/// # Errors
/// Errors of the sleep and of `work`.
pub(super) fn paced(
    steps: u32,
    options: &RealTime,
    mut work: impl FnMut() -> io::Result<Option<Duration>> + Send,
) -> io::Result<TimingReport> {
    let mut timings = Timings::new(ClockName::RealTime, PERIOD.as_micros() as u32, WARM_UP.into());
    let run = || -> io::Result<TimingReport> {
        let refused = obtain(options);
        let spin_ns = options.spin.as_nanos() as i64;
        let started_ns = now_ns();
        let mut step = 0;
        while step < i64::from(steps) {
            let due_ns = started_ns + step * PERIOD_NS;
            sleep_until(due_ns - spin_ns)?;
            while now_ns() < due_ns {
                hint::spin_loop();
            }
            let late_ns = now_ns() - due_ns;
            let trip = work()?.map(|time| RoundTrip {
                send: Duration::ZERO,
                line_and_device: time,
                compute: Duration::ZERO,
                receive: Duration::ZERO,
            });
            let lateness = Duration::from_nanos(late_ns.unsigned_abs());
            let mut push = |outcome, round_trip| {
                timings.push(&StepTiming { lateness, outcome, round_trip, tick_compute: None });
            };
            push(StepOutcome::Answered, trip);
            // Missed periods are omitted, as in the loop.
            let missed = late_ns / PERIOD_NS;
            (0..missed).for_each(|_| push(StepOutcome::Missed, None));
            step += 1 + missed;
        }
        Ok(timings.report(refused))
    };
    thread::scope(|scope| {
        let thread = thread::Builder::new().name("baseline".to_owned()).spawn_scoped(scope, run)?;
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

fn now_ns() -> i64 {
    let Timespec { tv_sec, tv_nsec } = clock_gettime(ClockId::Monotonic);
    tv_sec * 1_000_000_000 + tv_nsec
}

fn sleep_until(due_ns: i64) -> io::Result<()> {
    let due = Timespec { tv_sec: due_ns / 1_000_000_000, tv_nsec: due_ns % 1_000_000_000 };
    loop {
        match clock_nanosleep_absolute(ClockId::Monotonic, &due) {
            Ok(()) => return Ok(()),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
}
