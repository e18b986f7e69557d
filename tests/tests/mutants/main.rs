//! Tests of the conformance checks: a drive that the page allows passes them all, and a mutant of it does not.

mod allowed;
mod default_laws;
mod kill_rate;
mod laws;
mod mutation;
mod options;
mod options_of_specimen;
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
use specimen::{Character, FINE, FIXED, REAL, SLOW, Specimen};

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

/// Turns the power stage on, so that a host has to allow it.
const BENCH_MODE: &str = "bench_mode";

/// Each needs an option of the drive.
const OPTIONS: &str = "options";

/// Need bench mode.
const OF_PINS: [&str; 2] = [
    "Arm in bench mode checks session, state and parameters before the pins",
    "no limit of the duty is short of torque_limit_nm in either direction",
];

/// The names of the checks that were skipped, but for those of options, of a drive that passes all others.
fn skipped(link: impl Link + 'static) -> BTreeSet<String> {
    let mut results = results(link);
    results.retain(|it| it.status != CheckStatus::Passed);
    let broken: Vec<_> =
        results.iter().filter(|it| !matches!(it.status, CheckStatus::Skipped { .. })).collect();
    assert!(broken.is_empty(), "{broken:#?}");
    let needed = results.into_iter().filter(|it| !is_optional(it));
    needed.map(|it| it.name).collect()
}

/// Whether a check is of an option that the specimen lacks.
fn is_optional(it: &CheckResult) -> bool {
    [PROFILE, BENCH_MODE, OPTIONS].contains(&it.group) || OF_PINS.contains(&&*it.name)
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
    assert_eq!(skipped(Specimen::of(Character { is_chatty: true, ..Character::USUAL })), none());
}

#[test]
fn a_drive_without_a_clock_passes_every_check_but_that_of_its_clock() {
    let clock = "device time passes as the time of the bench does";
    let specimen = Specimen::of(Character { has_clock: false, ..Character::USUAL });
    assert_eq!(skipped(specimen), BTreeSet::from([clock.to_owned()]));
}

/// A late sample often comes before the look.
#[test]
fn a_drive_that_looks_at_its_watchdog_seldom_passes_every_check() {
    for (has_clock, look_us) in [(true, 60_000.0), (true, 97_000.0)] {
        let specimen = Specimen::of(Character { has_clock, look_us, ..Character::USUAL });
        assert_eq!(skipped(specimen), none());
    }
}

#[test]
fn a_drive_that_loses_bursts_fails_one_check() {
    let results = results(Specimen::of(Character { loses_bursts: true, ..Character::USUAL }));
    let broken = |it: &&CheckResult| !matches!(it.status, CheckStatus::Passed | CheckStatus::Skipped { .. });
    let broken: Vec<_> = results.iter().filter(broken).collect();
    assert!(broken.len() == 1 && broken[0].group == "burst", "{broken:#?}");
    assert_eq!(broken[0].note, "from here on every request is sent alone");
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

#[test]
fn a_drive_in_process_passes_every_check() {
    assert_eq!(skipped(InProcess::<TestLaws>::default()), none());
}
