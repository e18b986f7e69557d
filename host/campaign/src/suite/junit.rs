//! Results as a JUnit report, for build servers.

use std::time::Duration;

use quick_junit::{NonSuccessKind, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};

use super::case_result::{CaseResult, Status};

/// A case as the report names it: the scenario file is a suite of its cases.
pub struct Row<'a> {
    pub file: String,
    pub case: String,
    pub result: &'a CaseResult,
}

/// The report as XML: a suite for each file, a case for each case. A case without a verdict is an error. `shortfall` is why
/// the whole has no verdict, a case of its own with an error: a report never passes for lack of results.
///
/// # Errors
/// Errors of the XML writer.
pub fn report(name: &str, rows: &[Row<'_>], shortfall: Option<&str>) -> Result<String, SerializeError> {
    let mut report = Report::new(name);
    for group in rows.chunk_by(|one, next| one.file == next.file) {
        let mut suite = TestSuite::new(&*group[0].file);
        suite.add_test_cases(group.iter().map(case));
        report.add_test_suite(suite);
    }
    if let Some(cause) = shortfall {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
        status.set_message(cause);
        let mut case = TestCase::new("every case has a result and one has run", status);
        case.set_classname(name);
        let mut suite = TestSuite::new(name);
        suite.add_test_case(case);
        report.add_test_suite(suite);
    }
    report.set_time(rows.iter().map(|row| time(row.result)).sum());
    report.to_string()
}

fn case(Row { file, case, result }: &Row<'_>) -> TestCase {
    let mut status = match result.status {
        Status::Pass => TestCaseStatus::success(),
        Status::Skipped => TestCaseStatus::skipped(),
        Status::Fail => TestCaseStatus::non_success(NonSuccessKind::Failure),
        Status::Invalid | Status::BadScenario | Status::DeviceOrLink => {
            TestCaseStatus::non_success(NonSuccessKind::Error)
        }
    };
    if result.status != Status::Pass {
        status.set_type(result.status.word());
        if let Some(first) = result.reasons.first() {
            status.set_message(first);
        }
        if result.reasons.len() > 1 {
            status.set_description(result.reasons.join("\n"));
        }
    }
    let mut case = TestCase::new(&**case, status);
    case.set_classname(&**file).set_time(time(result));
    let record = result.record.as_ref().map(|record| record.display().to_string());
    let properties = [
        ("device", Some(result.device.clone()).filter(|device| !device.is_empty())),
        ("torque_sha256", result.torque_sha256.clone()),
        ("record", record),
    ];
    for (name, value) in properties {
        if let Some(value) = value {
            case.add_property((name, &*value));
        }
    }
    case
}

fn time(result: &CaseResult) -> Duration {
    Duration::try_from_secs_f64(result.wall_s).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_is_a_pass_a_failure_an_error_or_skipped() {
        let results = Status::ALL.map(|status| {
            let reasons = vec!["1 < 2 & \"so\"".to_owned(), "second".to_owned()];
            CaseResult::without_run("x.toml", status, reasons)
        });
        let row = |result| Row { file: "x.toml".to_owned(), case: "x".to_owned(), result };
        let rows: Vec<_> = results.iter().map(row).collect();
        let xml = report("lashloop test", &rows, None).expect("XML");
        assert!(xml.contains(r#"tests="6" skipped="1" failures="1" errors="3""#), "{xml}");
        assert!(xml.contains(r#"message="1 &lt; 2 &amp; &quot;so&quot;" type="FAIL""#), "{xml}");
    }

    #[test]
    fn a_report_without_results_is_an_error() {
        let xml = report("lashloop test", &[], Some("interrupted")).expect("XML");
        assert!(xml.contains(r#"tests="1" skipped="0" failures="0" errors="1""#), "{xml}");
    }
}
