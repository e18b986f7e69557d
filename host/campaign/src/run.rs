//! One case on a drive, in lockstep.

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::{self, Clock, DeviceUnderTest, End, Outcome, RunError};
use lashloop_bench::timing::ClockName;

use crate::campaign::Campaign;
use crate::cell::cells;
use crate::error::CampaignError;
use crate::plan::Case;
use crate::row::CaseResult;
use crate::workers::Stop;

/// Runs a case on a drive of its own; `None` if it was stopped. Nothing is shared between runs, so a result does not depend
/// on the runs next to it.
///
/// # Errors
/// The scenario rejects a setting, or drive, link or plant failed.
pub fn run_case(
    campaign: &Campaign,
    device: &DeviceChoice,
    number: u64,
    stop: &Stop<'_>,
) -> Result<Option<(Case, CaseResult)>, CampaignError> {
    let case = campaign.case(number)?;
    let scenario = campaign.scenario(&case)?;
    let failed = |source: RunError| CampaignError::Run { case: number, source: Box::new(source) };
    let opened = DeviceUnderTest::open(&scenario, device, ClockName::Lockstep, stop.supervisor, |link| link);
    let mut watcher = stop;
    let outcome = opened
        .map_err(RunError::from)
        .and_then(|mut device| run::run(&scenario, &mut device, Clock::Lockstep, &mut watcher));
    match outcome {
        Ok(outcome) if outcome.end == End::Interrupted => Ok(None),
        // A signal to the whole group of processes ends drives too.
        Err(_) if stop.asked() => Ok(None),
        Err(error) => Err(failed(error)),
        Ok(outcome) => {
            let result = result_of(campaign, &case, outcome);
            Ok(Some((case, result)))
        }
    }
}

/// What a run leaves in the table.
#[must_use]
pub fn result_of(campaign: &Campaign, case: &Case, outcome: Outcome) -> CaseResult {
    CaseResult {
        cells: cells(&outcome, &campaign.file.derived, |key| campaign.number(case, key)),
        verdict: outcome.judgement.verdict.to_string(),
        end: outcome.end.to_string(),
        torque_sha256: outcome.torque_sha256,
    }
}
