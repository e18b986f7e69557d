//! The results as a JUnit report, for build servers.

use std::fmt::Display;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::result::{CheckResult, CheckStatus};

/// The report as XML: a suite per group, a case per check. `device` describes the drive. A check that was not judged is an
/// error. `ended_by` is why the run ended before its last check, a case of its own with an error: a report never passes for
/// lack of results.
///
/// # Errors
/// Errors of the XML writer.
pub fn report(
    device: &str,
    results: &[CheckResult],
    ended_by: Option<&dyn Display>,
) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new("lashloop conformance");
    for group in results.chunk_by(|one, next| one.group == next.group) {
        let mut suite = TestSuite::new(group[0].group);
        suite.add_property(("device", device));
        suite.add_test_cases(group.iter().map(case));
        report.add_test_suite(suite);
    }
    if let Some(cause) = ended_by {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
        status.set_message(format!("the run ended early: {cause}"));
        let mut case = TestCase::new("the run reaches its last check", status);
        case.set_classname("conformance.run");
        let mut suite = TestSuite::new("run");
        suite.add_property(("device", device)).add_test_case(case);
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
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn result(status: CheckStatus) -> CheckResult {
        let name = "a torque has its sequence".to_owned();
        CheckResult {
            group: "samples",
            rules: "R7.2",
            name,
            status,
            note: String::new(),
            took: Duration::ZERO,
        }
    }

    #[test]
    fn a_check_that_was_not_judged_is_an_error() {
        let results = [
            result(CheckStatus::NotJudged { cause: "60 s have passed".to_owned() }),
            result(CheckStatus::Skipped { reason: "the drive has no signal" }),
            result(CheckStatus::Passed),
        ];
        let xml = report("a drive", &results, None).expect("XML");
        assert!(xml.contains(r#"tests="3" skipped="1" failures="0" errors="1""#), "{xml}");
        assert!(xml.contains(r#"<error message="not judged: 60 s have passed"/>"#), "{xml}");
        assert_eq!(xml.matches("<skipped").count(), 1, "{xml}");
    }

    #[test]
    fn a_run_without_a_result_is_an_error_with_its_diagnosis() {
        let xml = report("a drive", &[], Some(&"the drive was silent for 2.5 s")).expect("XML");
        assert!(xml.contains(r#"tests="1" skipped="0" failures="0" errors="1""#), "{xml}");
        assert!(xml.contains("the run ended early: the drive was silent for 2.5 s"), "{xml}");
    }
}
