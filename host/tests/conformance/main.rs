//! Who checks the checks: drives that break one rule each, and the check of that rule.

mod mutants;
mod variants;

use std::collections::BTreeSet;
use std::thread;

use lashloop::conformance::{CheckResult, CheckStatus, DeviceTime, Reporter, run};
use lashloop_bench::link::in_process::InProcess;
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
    run(Box::new(Mutant::new(variant)), 7, DeviceTime::Passes, &mut results).expect("a line that holds");
    results.0
}

fn failed(results: &[CheckResult]) -> BTreeSet<String> {
    let failed = results.iter().filter(|it| matches!(it.status, CheckStatus::Failed { .. }));
    failed.map(|it| it.name.clone()).collect()
}

#[test]
fn a_drive_that_is_right_passes_every_check() {
    let results = results(Variant::MERZOUKI);
    assert!(results.iter().all(|it| it.status == CheckStatus::Passed), "{results:#?}");
}

/// 1000 rad/s and these encoders make the longest gap 50 periods.
#[test]
fn a_drive_that_has_fine_encoders_passes_every_check() {
    let results = results(variants::FINE);
    assert!(results.iter().all(|it| it.status == CheckStatus::Passed), "{results:#?}");
}

#[test]
fn a_drive_that_has_one_period_and_one_resolution_passes_every_check() {
    let results = results(variants::FIXED);
    assert!(results.iter().all(|it| it.status == CheckStatus::Passed), "{results:#?}");
}

#[test]
fn jumps_and_gaps_are_checked_on_a_drive_that_has_one_period_and_one_resolution() {
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
fn what_the_ranges_of_a_drive_do_not_allow_is_skipped_and_said_so() {
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
    // It takes more than it says, and that is all that is wrong with it.
    let refuses = "a value out of range is refused and changes nothing".to_owned();
    assert_eq!(failed(&results), BTreeSet::from([refuses]));
}

/// Checks that no altered drive here can fail: it begins every check in Boot by the same Reset, gathers bytes to whole
/// frames before it alters anything, and says nothing but whole frames.
const OUT_OF_REACH: [&str; 3] = [
    "Reset leads from Boot to Boot",
    "a frame that arrives byte by byte is answered",
    "every frame from the drive was a good message",
];

#[test]
fn names_of_checks_are_unique() {
    let results = results(Variant::MERZOUKI);
    let names: BTreeSet<_> = results.iter().map(|it| &it.name).collect();
    assert_eq!(names.len(), results.len());
}

#[test]
fn every_broken_rule_is_caught_by_the_check_of_that_rule() {
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
    let every = results(Variant::MERZOUKI);
    let idle: Vec<_> = every.iter().map(|it| &it.name).filter(|name| !caught.contains(name)).collect();
    assert_eq!(idle, OUT_OF_REACH, "checks that no broken drive fails");
}

#[test]
fn in_process_what_needs_device_time_is_skipped_and_said_so() {
    let mut results = Results::default();
    run(Box::new(InProcess::default()), 7, DeviceTime::StandsStill, &mut results).expect("a drive");
    let (skipped, made): (Vec<_>, Vec<_>) =
        results.0.iter().partition(|it| matches!(it.status, CheckStatus::Skipped { .. }));
    assert!(made.iter().all(|it| it.status == CheckStatus::Passed));
    assert_eq!(skipped.len(), 3, "{skipped:#?}");
    assert!(skipped.iter().all(|it| it.name.contains("watchdog")));
}
