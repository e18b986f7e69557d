//! The results as a JUnit report, for the build servers that read nothing else.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::result::{CheckResult, CheckStatus};

/// The report as XML: a suite per group, a case per check. `device` is who was tested, in words.
///
/// # Errors
/// What the writer of XML said.
pub fn report(device: &str, results: &[CheckResult]) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new("lashloop conformance");
    for group in results.chunk_by(|one, next| one.group == next.group) {
        let mut suite = TestSuite::new(group[0].group);
        suite.add_property(("device", device));
        suite.add_test_cases(group.iter().map(case));
        report.add_test_suite(suite);
    }
    report.set_time(results.iter().map(|result| result.took).sum());
    report.to_string()
}

fn case(result: &CheckResult) -> TestCase {
    let status = match &result.status {
        CheckStatus::Passed => TestCaseStatus::success(),
        CheckStatus::Failed { expected, came } => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(format!("expected {expected}, got {came}"));
            status
        }
        CheckStatus::Skipped { reason } => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(*reason);
            status
        }
    };
    let mut case = TestCase::new(&*result.name, status);
    case.set_classname(format!("conformance.{}", result.group)).set_time(result.took);
    if !result.note.is_empty() {
        case.set_system_out(&*result.note);
    }
    case
}
