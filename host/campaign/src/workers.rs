//! Many runs, `jobs` at a time.
//!
//! Each run has a drive and a plant of its own, so results do not depend on the number of jobs. Only their order does.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

use lashloop_bench::run::StepObserver;
use lashloop_bench::supervisor::Supervisor;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    Complete,
    /// Stopped by the user. Unfinished runs leave no result.
    Interrupted,
}

/// Stops the workers, on a failure or on the user's signal.
pub struct Stop<'a> {
    failed: AtomicBool,
    pub supervisor: &'a Supervisor,
}

impl<'a> Stop<'a> {
    /// Stops on the user's signal.
    #[must_use]
    pub const fn new(supervisor: &'a Supervisor) -> Self {
        Self { failed: AtomicBool::new(false), supervisor }
    }

    pub fn asked(&self) -> bool {
        self.failed.load(Ordering::Relaxed) || self.supervisor.interrupted()
    }
}

impl StepObserver for &Stop<'_> {
    fn stop_asked(&self) -> bool {
        self.asked()
    }
}

/// Cases that are begun ahead of the oldest unfinished one, per job. Longer runs hold up the others no earlier than this.
const WINDOW_PER_JOB: u64 = 64;
/// Time after which a waiting worker looks for a signal of the user.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(100);

/// When results are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// As they arrive.
    Arrival,
    /// In the order of cases. A worker waits rather than begin a case far ahead of the oldest unfinished one, so that the
    /// number of results held back is bounded.
    Cases,
}

/// What the workers take cases from.
#[derive(Default)]
struct Queue {
    next: u64,
    kept: u64,
}

/// Runs the cases 0 to `count` - 1 by `run_one`, which returns `None` if it was stopped, and passes each result to `keep`, on
/// this thread.
///
/// # Errors
/// A run or `keep` fails; no further run is started.
pub fn run_all<R: Send, E: Send>(
    count: u64,
    jobs: NonZeroUsize,
    order: Order,
    supervisor: &Supervisor,
    run_one: impl Fn(u64, &Stop<'_>) -> Result<Option<R>, E> + Sync,
    mut keep: impl FnMut(R) -> Result<(), E>,
) -> Result<Ended, E> {
    let window = match order {
        Order::Arrival => u64::MAX,
        Order::Cases => WINDOW_PER_JOB * jobs.get() as u64,
    };
    let (queue, space) = (Mutex::new(Queue::default()), Condvar::new());
    let stop = Stop::new(supervisor);
    let mut kept_count = 0;
    let kept = thread::scope(|scope| {
        let (results, arrived) = mpsc::channel();
        for _ in 0..jobs.get().min(usize::try_from(count).unwrap_or(usize::MAX)) {
            let (results, queue, space, stop, run_one) = (results.clone(), &queue, &space, &stop, &run_one);
            scope.spawn(move || {
                let _guard = PanicGuard { stop, space };
                while let Some(case) = take(queue, space, stop, count, window) {
                    let Some(result) = run_one(case, stop).transpose() else { break };
                    if results.send((case, result)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(results);
        let mut early = BTreeMap::new();
        // Ends with the last worker, or at the first error; the channel then closes, which ends the workers.
        let kept = arrived.into_iter().try_for_each(|(case, result)| {
            early.insert(case, result?);
            while let Some(result) = match order {
                Order::Arrival => early.pop_first().map(|(_, result)| result),
                Order::Cases => early.remove(&kept_count),
            } {
                keep(result)?;
                kept_count += 1;
            }
            lock(&queue).kept = kept_count;
            space.notify_all();
            Ok(())
        });
        stop.failed.store(kept.is_err(), Ordering::Relaxed);
        space.notify_all();
        kept
    });
    kept?;
    Ok(if kept_count == count { Ended::Complete } else { Ended::Interrupted })
}

/// Stops the other workers if a run panics: the window would wait for its result forever. The scope then panics too.
struct PanicGuard<'a, 'b> {
    stop: &'a Stop<'b>,
    space: &'a Condvar,
}

impl Drop for PanicGuard<'_, '_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.stop.failed.store(true, Ordering::Relaxed);
            self.space.notify_all();
        }
    }
}

/// The next case, once it is within the window; `None` at the end or if the workers have to stop.
fn take(queue: &Mutex<Queue>, space: &Condvar, stop: &Stop<'_>, count: u64, window: u64) -> Option<u64> {
    let mut queue = lock(queue);
    loop {
        if stop.asked() || queue.next >= count {
            return None;
        }
        if queue.next - queue.kept < window {
            queue.next += 1;
            return Some(queue.next - 1);
        }
        let waited = space.wait_timeout(queue, SIGNAL_INTERVAL);
        queue = waited.unwrap_or_else(PoisonError::into_inner).0;
    }
}

fn lock(queue: &Mutex<Queue>) -> MutexGuard<'_, Queue> {
    queue.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;
    use std::time::Instant;

    use super::*;

    /// The first case ends only after all that may begin ahead of it.
    #[test]
    fn results_keep_the_order_of_cases_within_a_bounded_window() {
        let supervisor = Supervisor::without_signals(None).expect("a supervisor");
        let jobs = NonZeroUsize::new(2).expect("a number");
        let window = WINDOW_PER_JOB * 2;
        let begun = AtomicUsize::new(0);
        let mut kept = Vec::new();
        let ended = run_all(
            1000,
            jobs,
            Order::Cases,
            &supervisor,
            |case, stop| {
                begun.fetch_add(1, Ordering::Relaxed);
                while case == 0 && (begun.load(Ordering::Relaxed) as u64) < window && !stop.asked() {
                    thread::yield_now();
                }
                if case == 0 {
                    // Time for a worker that ignores the window.
                    thread::sleep(SIGNAL_INTERVAL / 4);
                    assert_eq!(
                        begun.load(Ordering::Relaxed) as u64,
                        window,
                        "cases begun ahead of the first"
                    );
                }
                Ok::<_, ()>(Some(case))
            },
            |case| {
                kept.push(case);
                Ok(())
            },
        );
        assert_eq!(ended, Ok(Ended::Complete));
        assert_eq!(kept, (0..1000).collect::<Vec<_>>());
    }

    /// The first case ends only after the others are kept.
    #[test]
    fn results_are_kept_as_they_arrive() {
        let supervisor = Supervisor::without_signals(None).expect("a supervisor");
        let jobs = NonZeroUsize::new(2).expect("a number");
        let (kept, give_up) = (Mutex::new(Vec::new()), Instant::now() + Duration::from_secs(20));
        let count = || kept.lock().unwrap_or_else(PoisonError::into_inner).len();
        let run_one = |case, _: &Stop<'_>| {
            while case == 0 && count() < 2 && Instant::now() < give_up {
                thread::yield_now();
            }
            Ok::<_, ()>(Some(case))
        };
        let keep = |case| {
            kept.lock().unwrap_or_else(PoisonError::into_inner).push(case);
            Ok(())
        };
        let ended = run_all(3, jobs, Order::Arrival, &supervisor, run_one, keep);
        assert_eq!(ended, Ok(Ended::Complete));
        assert_eq!(kept.into_inner().unwrap_or_else(PoisonError::into_inner), [1, 2, 0]);
    }

    #[test]
    #[should_panic(expected = "a scoped thread panicked")]
    fn run_that_panics_ends_the_others() {
        let supervisor = Supervisor::without_signals(None).expect("a supervisor");
        let jobs = NonZeroUsize::new(2).expect("a number");
        let run_one = |case, _: &Stop<'_>| {
            assert_ne!(case, 5, "a plant that panics");
            Ok::<_, ()>(Some(case))
        };
        let _ = run_all(100_000, jobs, Order::Cases, &supervisor, run_one, |_| Ok(()));
    }

    #[test]
    fn first_result_that_can_not_be_kept_ends_the_runs() {
        let supervisor = Supervisor::without_signals(None).expect("a supervisor");
        let jobs = NonZeroUsize::new(2).expect("a number");
        let wait = |case: u64, stop: &Stop<'_>| {
            while case > 0 && !stop.asked() {
                thread::yield_now();
            }
            Ok(Some(case))
        };
        let ended = run_all(u64::MAX, jobs, Order::Cases, &supervisor, wait, Err);
        assert_eq!(ended, Err(0));
    }
}
