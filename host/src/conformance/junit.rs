//! The results as a JUnit report, for build servers.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::result::{CheckResult, CheckStatus};

/// The report as XML: a suite per group, a case per check. `device` describes the drive.
///
/// # Errors
/// Errors of the XML writer.
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
        CheckStatus::Failed { expected, got } => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(format!("expected {expected}, got {got}"));
            status
        }
        CheckStatus::NotJudged { cause } => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(format!("not judged: {cause}"));
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
    case.add_property(("rules", result.rules));
    if !result.note.is_empty() {
        case.set_system_out(&*result.note);
    }
    case
}
