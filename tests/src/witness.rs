//! Witnesses of the machine: threads that do nothing but wake every millisecond, one on each core, while a test measures
//! wall-clock time. Where a test fails and a witness was late too, the failure shows the machine and not the program.

use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

/// Time between two looks at the clock.
const INTERVAL: Duration = Duration::from_millis(1);
/// Lateness of a witness from which a test that failed is not judged.
const LATE: Duration = Duration::from_millis(3);

/// Runs a test of wall-clock time. If it fails next to a late witness, it runs once more; if that gives no verdict either, it
/// prints a line that begins with `not judged: `, by which `cargo xtask test` counts it.
///
/// A test that passes next to a late witness has passed, because lateness can only exceed its bounds.
///
/// # Panics
/// The test panics with every witness in time.
pub fn judge(test: impl Fn()) {
    if judge_beside(latest, test) == Verdict::NotJudged {
        // Directly to the standard error: the test harness would keep what `eprintln!` writes.
        let _ = writeln!(io::stderr(), "not judged: a witness was late at both attempts");
    }
}

/// The verdict on a test that hasn't failed.
#[derive(Debug, PartialEq, Eq)]
enum Verdict {
    Passed,
    NotJudged,
}

fn judge_beside(witness: impl Fn(&AtomicBool) -> Duration + Sync, test: impl Fn()) -> Verdict {
    for _ in 0..2 {
        let is_over = AtomicBool::new(false);
        let (late, result) = thread::scope(|scope| {
            let late = scope.spawn(|| witness(&is_over));
            let result = catch_unwind(AssertUnwindSafe(&test));
            is_over.store(true, Ordering::Relaxed);
            (late.join().expect("a witness"), result)
        });
        match result {
            Ok(()) => return Verdict::Passed,
            Err(panic) if late < LATE => resume_unwind(panic),
            Err(_) => {
                let _ = writeln!(io::stderr(), "spoiled by the machine: a witness was {late:.1?} late");
            }
        }
    }
    Verdict::NotJudged
}

/// The largest lateness of a witness on any core until the test is over.
fn latest(is_over: &AtomicBool) -> Duration {
    let began = Instant::now();
    let cores = sched_getaffinity(None).ok().into_iter();
    let cores = cores.flat_map(|allowed| (0..CpuSet::MAX_CPU).filter(move |core| allowed.is_set(*core)));
    thread::scope(|scope| {
        let witnesses: Vec<_> =
            cores.map(|core| scope.spawn(move || latest_on(core, is_over, began))).collect();
        let late = witnesses.into_iter().map(|witness| witness.join().expect("a witness"));
        late.max().unwrap_or_default()
    })
}

/// From the beginning of the test on: a witness that first wakes after its end was late too.
fn latest_on(core: usize, is_over: &AtomicBool, began: Instant) -> Duration {
    let mut own = CpuSet::new();
    own.set(core);
    // A system that refuses leaves a witness on any core.
    let _ = sched_setaffinity(None, &own);
    let (mut latest, mut due) = (Duration::ZERO, began + INTERVAL);
    loop {
        thread::sleep(due.saturating_duration_since(Instant::now()));
        latest = latest.max(due.elapsed());
        if is_over.load(Ordering::Relaxed) {
            return latest;
        }
        due = Instant::now() + INTERVAL;
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// The verdict, `None` for a failure, and the number of attempts.
    fn judged(witness: Duration, fails: impl Fn(u32) -> bool) -> (Option<Verdict>, u32) {
        let attempts = Cell::new(0);
        let verdict = catch_unwind(AssertUnwindSafe(|| {
            judge_beside(
                |_| witness,
                || {
                    attempts.set(attempts.get() + 1);
                    assert!(!fails(attempts.get()), "a bound is exceeded");
                },
            )
        }));
        (verdict.ok(), attempts.get())
    }

    #[test]
    fn a_failure_counts_only_next_to_witnesses_in_time() {
        let (in_time, late) = (LATE / 2, 2 * LATE);
        assert_eq!(judged(in_time, |_| true), (None, 1), "a failure");
        assert_eq!(judged(late, |attempt| attempt == 1), (Some(Verdict::Passed), 2), "at the second attempt");
        assert_eq!(judged(late, |_| true), (Some(Verdict::NotJudged), 2));
        assert_eq!(judged(late, |_| false), (Some(Verdict::Passed), 1), "passes all the same");
    }

    #[test]
    fn a_witness_reports_when_it_wakes_late() {
        let is_over = AtomicBool::new(false);
        let late = thread::scope(|scope| {
            let late = scope.spawn(|| latest(&is_over));
            thread::sleep(20 * INTERVAL);
            is_over.store(true, Ordering::Relaxed);
            late.join().expect("a witness")
        });
        assert!(late > Duration::ZERO);
    }
}
