//! A specimen that stores parameters and captures signals: it passes every check, and one that errs there fails.

use lashloop_conformance::{CheckResult, CheckStatus, Reporter, run};

use crate::mutation::{Key, Mutant, Operator, Sites, When};
use crate::specimen::{Character, Specimen};
use crate::{OPTIONS, is_optional, results};

const WITH_OPTIONS: Character = Character { has_options: true, ..Character::USUAL };

const STATES: &str = "parameters are stored, recalled and forgotten in Idle alone";
const STORED: &str = "stored parameters are the defaults, after a reset too, until they are forgotten";
const REFUSALS: &str = "a Capture is refused for its first reason in the order of the table";
const KEPT: &str = "a capture is kept until the next one that is accepted, and no longer than Reset";
const ROWS: &str = "the rows of a capture have the values of the telemetry";
const LEVEL: &str = "a capture records around the first row beyond the level";
const FAULT: &str = "a capture records up to a fault";

/// Where a drive errs, how, and the check that finds it.
const WRONG: [(Key, Operator, &str); 33] = [
    (("StoreParameters", "is for Idle alone"), Operator::To(0), STATES),
    (("RecallParameters", "is for Idle alone"), Operator::To(0), STATES),
    (("ForgetParameters", "is for Idle alone"), Operator::To(0), STATES),
    (("StoreParameters", "is done"), Operator::Next, STORED),
    (("StoreParameters", "stores the last parameter"), Operator::Next, STORED),
    (("RecallParameters", "is done"), Operator::Next, STORED),
    (("RecallParameters", "takes the stored ones"), Operator::Next, STORED),
    (("ForgetParameters", "forgets"), Operator::Next, STORED),
    (("ForgetParameters", "sets the parameters"), Operator::Next, STORED),
    (("Reset restores", "damping_nm_s_rad"), Operator::Next, STORED),
    (("Capture", "refused for the state"), Operator::To(0), REFUSALS),
    (("Capture", "a bit without a signal"), Operator::To(0), REFUSALS),
    (("Capture", "before a bit without a signal"), Operator::Next, REFUSALS),
    (("Capture", "too many"), Operator::To(0), REFUSALS),
    (("Capture", "its rows"), Operator::To(0), REFUSALS),
    (("Capture", "its trigger"), Operator::To(0), REFUSALS),
    (("Capture", "a signal that isn't captured"), Operator::To(0), REFUSALS),
    (("Capture", "a level that isn't finite"), Operator::To(0), REFUSALS),
    (("Capture", "a signal that the law lacks"), Operator::To(0), REFUSALS),
    (("CommandResult", "detail"), Operator::Zero, REFUSALS),
    (("Capture", "refused changes nothing"), Operator::Next, KEPT),
    (("Capture", "without signals ends it"), Operator::Next, KEPT),
    (("Reset restores", "no capture"), Operator::Next, KEPT),
    (("ReadCapture", "ends the capture"), Operator::Next, KEPT),
    (("capture", "a row is due"), Operator::To(1), ROWS),
    (("capture", "is complete at the end of a run"), Operator::To(0), ROWS),
    (("ReadCapture", "detail without rows"), Operator::Zero, ROWS),
    (("ReadCapture", "values that fit"), Operator::Add(-1.0), ROWS),
    (("CaptureRows", "first"), Operator::Zero, ROWS),
    (("CaptureRows", "values"), Operator::Reversed, ROWS),
    (("capture", "rising"), Operator::To(1), LEVEL),
    (("capture", "falling"), Operator::To(0), LEVEL),
    (("capture", "keeps the last rows"), Operator::Next, FAULT),
];

#[test]
fn a_specimen_with_options_passes_their_checks() {
    let results = results(Specimen::like(Sites::new(None, None), WITH_OPTIONS));
    let of_bench_mode =
        |it: &CheckResult| is_optional(it) && it.group != OPTIONS || it.name.contains("SetZero");
    let broken: Vec<_> =
        results.iter().filter(|it| it.status != CheckStatus::Passed && !of_bench_mode(it)).collect();
    assert!(broken.is_empty(), "{broken:#?}");
}

/// The names of the checks of the options that fail.
#[derive(Default)]
struct Failed(Vec<String>);

impl Reporter for Failed {
    fn wants(&self, group: &str, _name: &str) -> bool {
        group == OPTIONS
    }

    fn checked(&mut self, result: &CheckResult) {
        if matches!(result.status, CheckStatus::Failed { .. }) {
            self.0.push(result.name.clone());
        }
    }
}

#[test]
fn a_specimen_that_errs_about_its_options_fails() {
    let mut borne = Vec::new();
    for (key, operator, check) in WRONG {
        let mutant = Mutant { key, operator, when: When::Always };
        let specimen = Specimen::like(Sites::new(Some(mutant), None), WITH_OPTIONS);
        let mut failed = Failed::default();
        run(Box::new(specimen), 7, &mut failed).expect("a drive that answers");
        if !failed.0.iter().any(|name| name == check) {
            borne.push(format!("{mutant}: {check}"));
        }
    }
    assert!(borne.is_empty(), "{borne:#?}");
}
