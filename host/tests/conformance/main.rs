//! Tests of the conformance checks: each mutant breaks one rule, and the check of that rule must fail.

mod allowed;
mod kill_rate;
mod laws;
mod mutants;
mod mutation;
mod specimen;
mod variants;

use std::collections::BTreeSet;
use std::thread;

use lashloop::conformance::{CheckResult, CheckStatus, Reporter, run};
use lashloop_bench::link::in_process::InProcess;
use laws::TestLaws;
use mutants::{Mutant, Variant};

#[derive(Default)]
struct Results(Vec<CheckResult>);

impl Reporter for Results {
    fn checked(&mut self, result: &CheckResult) {
        self.0.push(result.clone());
    }
}

fn results(variant: Variant) -> Vec<CheckResult> {
    let mut results = Results::default();
    run(Box::new(Mutant::new(variant)), 7, &mut results).expect("a line that holds");
    results.0
}

fn failed(results: &[CheckResult]) -> BTreeSet<String> {
    let failed = results.iter().filter(|it| matches!(it.status, CheckStatus::Failed { .. }));
    failed.map(|it| it.name.clone()).collect()
}

#[test]
fn unchanged_drive_passes_every_check() {
    let results = results(Variant::UNCHANGED);
    assert!(results.iter().all(|it| it.status == CheckStatus::Passed), "{results:#?}");
}

/// Whether every check has passed, and those of the profile `pd` too or were skipped: its golden trace needs encoders and
/// periods of its own.
fn passed_but_for_the_profile(results: &[CheckResult]) -> bool {
    results.iter().all(|it| match it.status {
        CheckStatus::Passed => true,
        CheckStatus::Skipped { .. } => it.group == "profile_pd",
        _ => false,
    })
}

/// With 1000 rad/s and these encoders the longest gap is 50 periods.
#[test]
fn drive_with_fine_encoders_passes_every_check() {
    let results = results(variants::FINE);
    assert!(passed_but_for_the_profile(&results), "{results:#?}");
}

#[test]
fn drive_with_one_period_and_resolution_passes_every_check() {
    let results = results(variants::FIXED);
    assert!(passed_but_for_the_profile(&results), "{results:#?}");
}

#[test]
fn jumps_and_gaps_are_checked_at_one_period_and_resolution() {
    let failed = failed(&results(variants::FIXED_CREDULOUS));
    for name in [
        "a gap is flagged GAP, once",
        "a motor encoder that jumps is a fault",
        "a load encoder that jumps is a fault",
    ] {
        assert!(failed.contains(name), "{name}: {failed:?}");
    }
}

#[test]
fn checks_outside_the_ranges_of_a_drive_are_skipped_aloud() {
    let results = results(variants::SLOW);
    let skipped: Vec<_> = results
        .iter()
        .filter(|it| matches!(it.status, CheckStatus::Skipped { reason } if reason.contains("speed limits")))
        .map(|it| it.name.as_str())
        .collect();
    let wanted = [
        "a gap is accepted up to the longest unambiguous one",
        "Arm is refused if one period leaves the position of the load ambiguous",
    ];
    assert_eq!(skipped, wanted);
    // This drive accepts values beyond its ranges; every other rule is kept.
    let refuses = "a value out of range is refused and changes nothing".to_owned();
    assert_eq!(failed(&results), BTreeSet::from([refuses]));
}

/// Checks that no mutant can fail. A mutant resets into Boot before every check, assembles whole frames before it changes
/// them, and sends whole frames only.
const OUT_OF_REACH: [&str; 3] = [
    "Reset leads from Boot to Boot",
    "a frame that arrives byte by byte is answered",
    "no frame from the drive was damaged",
];

#[test]
fn names_of_checks_are_unique() {
    let results = results(Variant::UNCHANGED);
    let names: BTreeSet<_> = results.iter().map(|it| &it.name).collect();
    assert_eq!(names.len(), results.len());
}

#[test]
fn every_broken_rule_fails_its_own_check() {
    let failures: Vec<_> = thread::scope(|scope| {
        let runs: Vec<_> =
            variants::all().map(|variant| scope.spawn(move || failed(&results(variant)))).collect();
        runs.into_iter().map(|run| run.join().expect("a battery that ends")).collect()
    });
    let missed: Vec<_> = variants::all()
        .zip(&failures)
        .filter(|(variant, failed)| !failed.contains(variant.caught_by))
        .map(|(variant, failed)| format!("a drive that {}: {failed:?}", variant.does))
        .collect();
    assert!(missed.is_empty(), "not caught by their check:\n{}", missed.join("\n"));
    let caught: BTreeSet<_> = failures.iter().flatten().collect();
    let every = results(Variant::UNCHANGED);
    let idle: Vec<_> = every.iter().map(|it| &it.name).filter(|name| !caught.contains(name)).collect();
    assert_eq!(idle, OUT_OF_REACH, "checks that no broken drive fails");
}

#[test]
fn a_drive_in_process_passes_every_check_and_none_is_skipped() {
    let mut results = Results::default();
    run(Box::new(InProcess::<TestLaws>::default()), 7, &mut results).expect("a drive");
    assert!(results.0.iter().all(|it| it.status == CheckStatus::Passed), "{:#?}", results.0);
}
