//! Makes the runs: the very drive of the firmware in process, as many at a time as there are jobs.
//!
//! Every run has a drive and a plant of its own and shares nothing, so what comes out doesn't depend on the number of jobs. Only
//! the order does in which runs end.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use serde::{Deserialize, Serialize};

use super::BatteryError;
use super::plan::{Case, CaseId};
use super::score::Scores;
use crate::device::{Device, DeviceChoice};
use crate::record::RecordError;
use crate::run::{self, Clock, End, RunError, Step, Watcher};
use crate::supervisor::Supervisor;

/// What came of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseResult {
    /// Where it belongs.
    pub case: CaseId,
    /// How it ended.
    pub end: String,
    /// Its figures.
    pub scores: Scores,
    /// Digest of the torque stream, see [`TorqueDigest`](crate::record::digest::TorqueDigest).
    pub torque_sha256: String,
}

/// How a battery ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// Every run was made.
    Complete,
    /// The user asked to stop. Runs that were under way have left nothing.
    Interrupted,
}

/// Makes the runs, and hands over each result on this thread as it comes.
///
/// # Errors
/// A run could not be made or its result not be kept; then no further run is begun.
pub fn run_all(
    cases: &[&Case],
    jobs: NonZeroUsize,
    supervisor: &Supervisor,
    mut keep: impl FnMut(CaseResult) -> Result<(), BatteryError>,
) -> Result<Ended, BatteryError> {
    let next = AtomicUsize::new(0);
    let stop = Stop { failed: AtomicBool::new(false), supervisor };
    let mut count = 0;
    let kept = thread::scope(|scope| {
        let (results, ended) = mpsc::channel();
        for _ in 0..jobs.get().min(cases.len()) {
            let (results, next, stop) = (results.clone(), &next, &stop);
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
        // Ends when the last worker has, or returns at once with the first error and leaves the others nobody to tell.
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

/// `None` if it was asked to stop.
fn run_one(case: &Case, stop: &Stop<'_>) -> Result<Option<CaseResult>, BatteryError> {
    let failed = |source: RunError| BatteryError::Run { case: case.id, source: Box::new(source) };
    let mut device = Device::open(&DeviceChoice::InProcess, case.scenario.link.baud, stop.supervisor)
        .map_err(|source| failed(source.into()))?;
    let mut watcher = stop;
    let outcome = run::run(&case.scenario, &mut device, Clock::Lockstep, &mut watcher).map_err(failed)?;
    if outcome.end == End::Interrupted {
        return Ok(None);
    }
    Ok(Some(CaseResult {
        case: case.id,
        end: outcome.end.to_string(),
        scores: Scores::of(&outcome),
        torque_sha256: outcome.torque_sha256,
    }))
}

/// Why to begin no further run, and to end those under way.
struct Stop<'a> {
    failed: AtomicBool,
    supervisor: &'a Supervisor,
}

impl Stop<'_> {
    fn asked(&self) -> bool {
        self.failed.load(Ordering::Relaxed) || self.supervisor.interrupted()
    }
}

impl Watcher for &Stop<'_> {
    fn step(&mut self, _step: &Step) -> Result<(), RecordError> {
        Ok(())
    }

    fn stop_asked(&self) -> bool {
        self.asked()
    }
}
