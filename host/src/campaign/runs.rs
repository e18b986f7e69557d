//! Runs the cases with the firmware's drive in process, `jobs` at a time.
//!
//! Every run has its own drive and plant and shares no state, so results do not depend on the number of jobs. Only their order
//! does.

use std::num::NonZeroUsize;

use super::case::{Case, CaseResult};
use super::error::CampaignError;
use super::score::Scores;
use crate::workers::{self, Ended, Stop};
use lashloop_bench::device::Device;
use lashloop_bench::device::kinds::in_process::InProcessDrive;
use lashloop_bench::run::{self, Clock, End, RunError};
use lashloop_bench::supervisor::Supervisor;

/// Runs the cases and passes each result to `keep`, on this thread, as it arrives.
///
/// # Errors
/// A run or `keep` fails; no further run is started.
pub fn run_all(
    cases: &[&Case],
    jobs: NonZeroUsize,
    supervisor: &Supervisor,
    keep: impl FnMut(CaseResult) -> Result<(), CampaignError>,
) -> Result<Ended, CampaignError> {
    workers::run_all(cases, jobs, supervisor, |case, stop| run_one(case, stop), keep)
}

/// `None` if the run was stopped.
fn run_one(case: &Case, stop: &Stop<'_>) -> Result<Option<CaseResult>, CampaignError> {
    let failed = |source: RunError| CampaignError::Run { case: case.id, source: Box::new(source) };
    let device = Device::open(&<InProcessDrive>::default().into(), case.scenario.link.baud, stop.supervisor)
        .map_err(|source| failed(source.into()))?;
    let mut device = device.into();
    let mut watcher = stop;
    let outcome = run::run(&case.scenario, &mut device, Clock::Lockstep, &mut watcher).map_err(failed)?;
    if outcome.end == End::Interrupted {
        return Ok(None);
    }
    Ok(Some(CaseResult {
        case: case.id,
        end: outcome.end.to_string(),
        scores: Scores::of(&outcome, case.scenario.encoders.load_counts_per_rev),
        torque_sha256: outcome.torque_sha256,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::case::{CaseId, Part};
    use crate::campaign::law::Law;
    use crate::campaign::plan::{self, Settings};
    use crate::campaign::score::{Criterion, MissingReason, Score};
    use lashloop_bench::scenario::{Override, Scenario};

    fn case(settings: &[&str]) -> Case {
        let text = include_str!("../../../scenarios/shaft-pd.toml");
        let overrides: Vec<_> = settings.iter().map(|it| Override::Set((*it).to_owned())).collect();
        let id = CaseId { part: Part::DeadZone, row: settings.len() as u32, law: Law::BEFORE };
        let scenario = Scenario::from_str("shaft-pd.toml", text, &overrides).expect("a scenario");
        Case { id, settings: Vec::new(), scenario }
    }

    fn results_of(cases: &[Case], jobs: usize) -> Vec<CaseResult> {
        let supervisor = Supervisor::start(std::path::PathBuf::new()).expect("a supervisor");
        let cases: Vec<_> = cases.iter().collect();
        let jobs = NonZeroUsize::new(jobs).expect("a job");
        let mut results = Vec::new();
        let ended = run_all(&cases, jobs, &supervisor, |result| {
            results.push(result);
            Ok(())
        });
        assert_eq!(ended.expect("runs"), Ended::Complete);
        results.sort_by_key(|result| result.case);
        results
    }

    #[test]
    fn diverged_or_faulted_run_has_no_score() {
        let stiff = ["plant.load_friction=lugre", "plant.bristle_stiffness_nm_rad=1e8"];
        let jump = ["controller.parameters.motor_speed_limit_rad_s=2"];
        let results = results_of(&[case(&jump), case(&stiff)], 1);
        let reasons = [
            (MissingReason::CutShort, "the drive latched MotorEncoderJump"),
            (MissingReason::NotFinite, "the plant can't be followed any further"),
        ];
        for (result, (reason, end)) in results.iter().zip(reasons) {
            assert!(result.end.starts_with(end), "{result:?}");
            assert_eq!(
                Criterion::ALL.map(|it| result.scores.get(it)),
                [Score::Missing(reason); Criterion::ALL.len()],
                "{result:?}"
            );
        }
    }

    #[test]
    fn results_are_the_same_bits_for_any_number_of_jobs() {
        let settings = Settings { seed: 5, plants: 2, laws: Law::ALL.to_vec(), sweeps: false };
        let mut cases = plan::cases(&settings).expect("cases");
        for case in &mut cases {
            case.scenario.run.duration_s = 12.0;
        }
        let one = results_of(&cases, 1);
        assert_eq!(one.len(), 2 * Law::ALL.len());
        assert_eq!(one, results_of(&cases, 4));
    }

    #[test]
    fn first_result_that_can_not_be_kept_ends_the_battery() {
        let supervisor = Supervisor::start(std::path::PathBuf::new()).expect("a supervisor");
        let mut case = case(&[]);
        // Longer than any test, so that only a stop ends the other runs.
        let short = case.clone();
        case.scenario.run.duration_s = 1e5;
        let mut count = 0;
        let jobs = NonZeroUsize::new(2).expect("a job");
        let ended = run_all(&[&case, &short, &case, &case], jobs, &supervisor, |_| {
            count += 1;
            let path = "runs.jsonl".into();
            Err(crate::journal::JournalError::InUse { path }.into())
        });
        assert!(matches!(ended, Err(CampaignError::Journal(_))), "{ended:?}");
        assert_eq!(count, 1);
    }
}
