//! The findings as a JUnit report, for the build servers that read nothing else.

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::{Finding, Outcome};

/// The report as XML: a suite per group, a case per check. `device` is who was tested, in words.
///
/// # Errors
/// What the writer of XML said.
pub fn report(device: &str, findings: &[Finding]) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new("lashloop conformance");
    for group in findings.chunk_by(|one, next| one.group == next.group) {
        let mut suite = TestSuite::new(group[0].group);
        suite.add_property(("device", device));
        suite.add_test_cases(group.iter().map(case));
        report.add_test_suite(suite);
    }
    report.set_time(findings.iter().map(|finding| finding.took).sum());
    report.to_string()
}

fn case(finding: &Finding) -> TestCase {
    let status = match &finding.outcome {
        Outcome::Passed => TestCaseStatus::success(),
        Outcome::Failed { expected, came } => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(format!("expected {expected}, got {came}"));
            status
        }
        Outcome::LeftOut { reason } => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(*reason);
            status
        }
    };
    let mut case = TestCase::new(&*finding.name, status);
    case.set_classname(format!("conformance.{}", finding.group)).set_time(finding.took);
    if !finding.note.is_empty() {
        case.set_system_out(&*finding.note);
    }
    case
}
