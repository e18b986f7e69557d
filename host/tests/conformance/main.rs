//! Who checks the checks: drives that break one rule each, and the check of that rule.

mod mutants;
mod variants;

use std::collections::BTreeSet;
use std::thread;

use lashloop::conformance::{Finding, Outcome, Watcher, run};
use lashloop_bench::link::in_process::InProcess;
use mutants::{Altered, Variant};

#[derive(Default)]
struct Findings(Vec<Finding>);

impl Watcher for Findings {
    fn found(&mut self, finding: &Finding) {
        self.0.push(finding.clone());
    }
}

fn findings(variant: Variant) -> Vec<Finding> {
    let mut findings = Findings::default();
    run(Box::new(Altered::new(variant)), 7, &mut findings).expect("a line that holds");
    findings.0
}

fn failed(findings: &[Finding]) -> BTreeSet<String> {
    let failed = findings.iter().filter(|it| matches!(it.outcome, Outcome::Failed { .. }));
    failed.map(|it| it.name.clone()).collect()
}

#[test]
fn a_drive_that_is_right_passes_every_check() {
    let findings = findings(Variant::MERZOUKI);
    assert!(findings.iter().all(|it| it.outcome == Outcome::Passed), "{findings:#?}");
}

/// 1000 rad/s and these encoders make the longest gap 50 periods.
#[test]
fn a_drive_that_has_fine_encoders_passes_every_check() {
    let findings = findings(variants::FINE);
    assert!(findings.iter().all(|it| it.outcome == Outcome::Passed), "{findings:#?}");
}

#[test]
fn a_drive_that_has_one_period_and_one_resolution_passes_every_check() {
    let findings = findings(variants::FIXED);
    assert!(findings.iter().all(|it| it.outcome == Outcome::Passed), "{findings:#?}");
}

#[test]
fn jumps_and_gaps_are_checked_on_a_drive_that_has_one_period_and_one_resolution() {
    let failed = failed(&findings(variants::FIXED_CREDULOUS));
    for name in [
        "a gap is flagged GAP, once",
        "a motor encoder that jumps is a fault",
        "a load encoder that jumps is a fault",
    ] {
        assert!(failed.contains(name), "{name}: {failed:?}");
    }
}

#[test]
fn what_the_ranges_of_a_drive_do_not_allow_is_left_out_and_said_so() {
    let findings = findings(variants::SLOW);
    let left_out: Vec<_> = findings
        .iter()
        .filter(|it| matches!(it.outcome, Outcome::LeftOut { reason } if reason.contains("speed limits")))
        .map(|it| it.name.as_str())
        .collect();
    let wanted = [
        "a gap is taken as long as positions can be told apart, and no longer",
        "Arm is refused if no period tells positions of the load apart",
    ];
    assert_eq!(left_out, wanted);
    // It takes more than it says, and that is all that is wrong with it.
    let refuses = "a value out of range is refused and changes nothing".to_owned();
    assert_eq!(failed(&findings), BTreeSet::from([refuses]));
}

/// Checks that no altered drive here can fail: it begins every check in Boot by the same Reset, gathers bytes to whole
/// frames before it alters anything, and says nothing but whole frames.
const OUT_OF_REACH: [&str; 3] = [
    "Reset leads from Boot to Boot",
    "a frame that comes byte by byte is answered",
    "everything the drive has sent has arrived whole and is a message",
];

#[test]
fn names_of_checks_are_unique() {
    let findings = findings(Variant::MERZOUKI);
    let names: BTreeSet<_> = findings.iter().map(|it| &it.name).collect();
    assert_eq!(names.len(), findings.len());
}

#[test]
fn every_broken_rule_is_caught_by_the_check_of_that_rule() {
    let failures: Vec<_> = thread::scope(|scope| {
        let runs: Vec<_> =
            variants::all().map(|variant| scope.spawn(move || failed(&findings(variant)))).collect();
        runs.into_iter().map(|run| run.join().expect("a battery that ends")).collect()
    });
    let missed: Vec<_> = variants::all()
        .zip(&failures)
        .filter(|(variant, failed)| !failed.contains(variant.caught_by))
        .map(|(variant, failed)| format!("a drive that {}: {failed:?}", variant.does))
        .collect();
    assert!(missed.is_empty(), "not caught by their check:\n{}", missed.join("\n"));
    let caught: BTreeSet<_> = failures.iter().flatten().collect();
    let every = findings(Variant::MERZOUKI);
    let idle: Vec<_> = every.iter().map(|it| &it.name).filter(|name| !caught.contains(name)).collect();
    assert_eq!(idle, OUT_OF_REACH, "checks that no broken drive fails");
}

#[test]
fn a_drive_in_process_passes_every_check_and_none_is_left_out() {
    let mut findings = Findings::default();
    run(Box::new(InProcess::default()), 7, &mut findings).expect("a drive");
    assert!(findings.0.iter().all(|it| it.outcome == Outcome::Passed), "{:#?}", findings.0);
}
