//! Tests of the conformance checks: a drive that the page allows passes them all, and a mutant of it does not.

mod allowed;
mod default_laws;
mod kill_rate;
mod laws;
mod mutation;
mod profile_pd;
mod specimen;
mod traffic;
mod wrong_laws;

use std::collections::BTreeSet;

use lashloop_conformance::{CheckResult, CheckStatus, Reporter, run};
use lashloop_link::Link;
use lashloop_link::in_process::InProcess;
use laws::TestLaws;
use mutation::{Mutant, Operator, Sites, When};
use specimen::{FINE, FIXED, REAL, SLOW, Specimen};

#[derive(Default)]
struct Results(Vec<CheckResult>);

impl Reporter for Results {
    fn checked(&mut self, result: &CheckResult) {
        self.0.push(result.clone());
    }
}

fn results(link: impl Link + 'static) -> Vec<CheckResult> {
    let mut results = Results::default();
    run(Box::new(link), 7, &mut results).expect("a drive that answers");
    results.0
}

fn unchanged() -> Sites {
    Sites::new(None, None)
}

/// The optional profile needs a law `pd`, and encoders and periods of its own.
const PROFILE: &str = "profile_pd";

/// The names of the checks that were skipped, but for those of the profile, of a drive that passes all others.
fn skipped(link: impl Link + 'static) -> BTreeSet<String> {
    let mut results = results(link);
    results.retain(|it| it.status != CheckStatus::Passed);
    let broken: Vec<_> =
        results.iter().filter(|it| !matches!(it.status, CheckStatus::Skipped { .. })).collect();
    assert!(broken.is_empty(), "{broken:#?}");
    results.into_iter().filter(|it| it.group != PROFILE).map(|it| it.name).collect()
}

fn none() -> BTreeSet<String> {
    BTreeSet::new()
}

#[test]
fn names_of_checks_are_unique() {
    let results = results(Specimen::new(unchanged()));
    let names: BTreeSet<_> = results.iter().map(|it| &it.name).collect();
    assert_eq!(names.len(), results.len());
}

#[test]
fn drive_with_fine_encoders_passes_every_check() {
    assert_eq!(skipped(Specimen::with(unchanged(), &FINE)), none());
}

#[test]
fn drive_with_real_numbers_passes_every_check() {
    assert_eq!(skipped(Specimen::with(unchanged(), &REAL)), none());
}

#[test]
fn drive_with_one_period_and_resolution_passes_every_check() {
    let ambiguous = "Arm is refused if one period leaves the position of the load ambiguous";
    assert_eq!(skipped(Specimen::with(unchanged(), &FIXED)), BTreeSet::from([ambiguous.to_owned()]));
}

#[test]
fn logs_and_messages_of_a_later_version_are_borne_at_any_time() {
    assert_eq!(skipped(Specimen::chatty()), none());
}

#[test]
fn jumps_and_gaps_are_checked_at_one_period_and_resolution() {
    for (key, check) in [
        (("motor jump", "beyond the limit"), "a motor encoder that jumps is a fault"),
        (("load jump", "beyond the limit"), "a load encoder that jumps is a fault"),
        (("torque", "is after a gap"), "a gap is flagged GAP, once"),
    ] {
        let mutant = Mutant { key, operator: Operator::To(0), when: When::Always };
        let results = results(Specimen::with(Sites::new(Some(mutant), None), &FIXED));
        let failed = |it: &CheckResult| it.name == check && matches!(it.status, CheckStatus::Failed { .. });
        assert!(results.iter().any(failed), "{check}: {results:#?}");
    }
}

#[test]
fn checks_outside_the_ranges_of_a_drive_are_skipped_aloud() {
    let skipped = skipped(Specimen::with(unchanged(), &SLOW));
    let wanted = [
        "Arm is refused if one period leaves the position of the load ambiguous",
        "a gap is accepted up to the longest unambiguous one",
    ];
    assert_eq!(skipped, wanted.map(ToOwned::to_owned).into());
}

/// None of its parameters is live.
#[test]
fn a_drive_in_process_passes_every_check() {
    let skipped = skipped(InProcess::<TestLaws>::default());
    assert!(skipped.iter().all(|name| name.contains("live")), "{skipped:?}");
}
