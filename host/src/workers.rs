//! Many runs, `jobs` at a time.
//!
//! Each run has a drive and a plant of its own, so results do not depend on the number of jobs. Only their order does.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

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

impl Stop<'_> {
    pub fn asked(&self) -> bool {
        self.failed.load(Ordering::Relaxed) || self.supervisor.interrupted()
    }
}

impl StepObserver for &Stop<'_> {
    fn stop_asked(&self) -> bool {
        self.asked()
    }
}

/// Runs the cases by `run_one`, which returns `None` if it was stopped, and passes each result to `keep`, on this thread, as
/// it arrives.
///
/// # Errors
/// A run or `keep` fails; no further run is started.
pub fn run_all<C: Sync, R: Send, E: Send>(
    cases: &[C],
    jobs: NonZeroUsize,
    supervisor: &Supervisor,
    run_one: impl Fn(&C, &Stop<'_>) -> Result<Option<R>, E> + Sync,
    mut keep: impl FnMut(R) -> Result<(), E>,
) -> Result<Ended, E> {
    let next = AtomicUsize::new(0);
    let stop = Stop { failed: AtomicBool::new(false), supervisor };
    let mut count = 0;
    let kept = thread::scope(|scope| {
        let (results, ended) = mpsc::channel();
        for _ in 0..jobs.get().min(cases.len()) {
            let (results, next, stop, run_one) = (results.clone(), &next, &stop, &run_one);
            scope.spawn(move || {
                while !stop.asked() {
                    let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                    let Some(result) = run_one(case, stop).transpose() else { break };
                    if results.send(result).is_err() {
                        break;
                    }
                }
            });
        }
        drop(results);
        // Ends with the last worker, or at the first error; the channel then closes, which ends the workers.
        let kept = ended.into_iter().try_for_each(|result| {
            count += 1;
            keep(result?)
        });
        stop.failed.store(kept.is_err(), Ordering::Relaxed);
        kept
    });
    kept?;
    Ok(if count == cases.len() { Ended::Complete } else { Ended::Interrupted })
}
