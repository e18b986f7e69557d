//! One case on a drive, in lockstep.

use std::fmt;

use lashloop::execution::{Execution, ExecutionError};
use lashloop_bench::device::{DeviceChoice, DeviceError};
use lashloop_bench::run::digest::TorqueDigest;
use lashloop_bench::run::{Clock, End, Outcome, RunError};
use lashloop_bench::verdict::Verdict;
use lashloop_plant::PlantError;

use crate::campaign::Campaign;
use crate::cell::{Cell, Missing, cells};
use crate::error::CampaignError;
use crate::plan::Case;
use crate::row::CaseResult;
use crate::workers::Stop;

/// Begins the end of a case that has no run, because of its own settings or of its drive; the reason follows.
pub const NO_RUN: &str = "no run: ";

/// Runs a case on a drive of its own; `None` if it was stopped. Nothing is shared between runs, so a result does not depend
/// on the runs next to it. A case whose settings permit no run, or whose drive ends twice, is INVALID with [`NO_RUN`]: as an
/// error it would end each further attempt at its shard too.
///
/// # Errors
/// Device or link failed for a reason that further cases share.
pub fn run_case(
    campaign: &Campaign,
    device: &DeviceChoice,
    number: u64,
    stop: &Stop<'_>,
) -> Result<Option<(Case, CaseResult)>, CampaignError> {
    let case = campaign.case(number)?;
    let scenario = match campaign.scenario(&case) {
        Err(CampaignError::Case { source, .. }) => {
            let result = no_run(campaign, &source);
            return Ok(Some((case, result)));
        }
        scenario => scenario?,
    };
    let attempt = |scenario| {
        let mut watcher = stop;
        let execution = Execution::new(scenario, device.into()).clock(Clock::Untimed).watch(&mut watcher);
        execution.run(stop.supervisor).map(|made| made.outcome)
    };
    let mut outcome = attempt(scenario);
    // The system may have ended the drive, for instance without memory.
    let has_ended = matches!(outcome, Err(ExecutionError::Run(RunError::Device(DeviceError::Ended { .. }))));
    if has_ended && !stop.asked() {
        outcome = attempt(campaign.scenario(&case)?);
    }
    let result = match outcome {
        Ok(outcome) if outcome.end == End::Interrupted => return Ok(None),
        Ok(outcome) => result_of(campaign, &case, outcome),
        // A signal to the whole group of processes ends drives too.
        Err(_) if stop.asked() => return Ok(None),
        Err(error) => match reason(&error) {
            Some(reason) => no_run(campaign, &reason),
            None => return Err(CampaignError::Run { case: number, source: Box::new(error) }),
        },
    };
    Ok(Some((case, result)))
}

/// Why this case has no run, in the same words each time; `None` if others may have none either.
fn reason(error: &ExecutionError) -> Option<String> {
    let ExecutionError::Run(error) = error else { return None };
    match error {
        RunError::Integration(PlantError::Interrupted) => None,
        RunError::Scenario(_)
        | RunError::Inconsistent { .. }
        | RunError::TooFarToStart { .. }
        | RunError::Plant(_)
        | RunError::Integration(_) => Some(error.to_string()),
        // Process id and standard error differ from run to run.
        RunError::Device(DeviceError::Ended { name, status, .. }) => {
            Some(format!("the {name} ended, {status}"))
        }
        RunError::Device(_)
        | RunError::Record(_)
        | RunError::Fault(_)
        | RunError::NoPins { .. }
        | RunError::BenchClock { .. }
        | RunError::RecordBehind { .. }
        | RunError::Pace(_) => None,
    }
}

fn no_run(campaign: &Campaign, reason: &dyn fmt::Display) -> CaseResult {
    CaseResult {
        cells: vec![Cell::Missing(Missing::CutShort); campaign.file.number_columns().len()],
        verdict: Verdict::Invalid.to_string(),
        // In one line, as a row is.
        end: format!("{NO_RUN}{reason}").replace('\n', "; "),
        torque_sha256: TorqueDigest::default().finish(),
    }
}

/// What a run leaves in the table.
#[must_use]
pub fn result_of(campaign: &Campaign, case: &Case, outcome: Outcome) -> CaseResult {
    CaseResult {
        cells: cells(&outcome, &campaign.file.derived, &(campaign, case)),
        verdict: outcome.judgement.verdict.to_string(),
        end: outcome.end.to_string(),
        torque_sha256: outcome.torque_sha256,
    }
}
