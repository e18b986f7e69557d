//! Results as a JUnit report, for build servers.

use std::time::Duration;

use lashloop_campaign::suite::case_result::{CaseResult, Status};
use quick_junit::{NonSuccessKind, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};

/// What became of a case in the terms of JUnit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Success,
    Failure,
    /// Without a verdict.
    Error,
    Skipped,
}

/// A case of a report. Cases of a suite follow each other.
#[derive(Debug)]
pub struct Case {
    pub suite: String,
    pub class: String,
    pub name: String,
    pub kind: Kind,
    /// The report's own word for it.
    pub word: Option<&'static str>,
    /// Why it isn't a success; the first is the short form.
    pub reasons: Vec<String>,
    pub took: Duration,
    pub properties: Vec<(&'static str, String)>,
    /// A measurement for information.
    pub output: String,
}

impl Case {
    /// A case of this kind without reason, time or property.
    #[must_use]
    pub fn new(suite: &str, class: &str, name: &str, kind: Kind) -> Self {
        Self {
            suite: suite.to_owned(),
            class: class.to_owned(),
            name: name.to_owned(),
            kind,
            word: None,
            reasons: Vec::new(),
            took: Duration::ZERO,
            properties: Vec::new(),
            output: String::new(),
        }
    }

    /// The case of a run. The scenario file is the suite of its cases.
    #[must_use]
    pub fn of_run(file: &str, name: &str, result: &CaseResult) -> Self {
        let kind = match result.status {
            Status::Pass => Kind::Success,
            Status::Skipped => Kind::Skipped,
            Status::Fail => Kind::Failure,
            Status::Invalid | Status::BadScenario | Status::DeviceOrLink => Kind::Error,
        };
        let properties = [
            ("device", Some(result.device.clone()).filter(|device| !device.is_empty())),
            ("torque_sha256", result.torque_sha256.clone()),
            // A pass of it says nothing of the drive.
            (
                "expectations",
                (result.torque_sha256.is_some() && result.checks.is_empty()).then(|| "none".to_owned()),
            ),
            ("record", result.record.as_ref().map(|record| record.display().to_string())),
        ];
        Self {
            word: Some(result.status.word()),
            reasons: result.reasons.clone(),
            took: Duration::try_from_secs_f64(result.wall_s).unwrap_or_default(),
            properties: properties.into_iter().filter_map(|(name, value)| Some((name, value?))).collect(),
            ..Self::new(file, file, name, kind)
        }
    }
}

/// The report as XML. `shortfall` is why the whole has no verdict, as a case with an error: a report never passes for lack of
/// results.
///
/// # Errors
/// Errors of the XML writer.
pub fn report(name: &str, cases: &[Case], shortfall: Option<&str>) -> Result<String, SerializeError> {
    let short = shortfall.map(|cause| Case {
        reasons: vec![cause.to_owned()],
        ..Case::new(name, name, "every case has a result and one has run", Kind::Error)
    });
    let cases: Vec<_> = cases.iter().chain(&short).collect();
    let mut report = Report::new(name);
    for group in cases.chunk_by(|one, next| one.suite == next.suite) {
        let mut suite = TestSuite::new(&*group[0].suite);
        suite.add_test_cases(group.iter().map(|case| test_case(case)));
        report.add_test_suite(suite);
    }
    report.set_time(cases.iter().map(|case| case.took).sum());
    report.to_string()
}

fn test_case(case: &Case) -> TestCase {
    let mut status = match case.kind {
        Kind::Success => TestCaseStatus::success(),
        Kind::Failure => TestCaseStatus::non_success(NonSuccessKind::Failure),
        Kind::Error => TestCaseStatus::non_success(NonSuccessKind::Error),
        Kind::Skipped => TestCaseStatus::skipped(),
    };
    if case.kind != Kind::Success {
        if let Some(word) = case.word {
            status.set_type(word);
        }
        if let Some(first) = case.reasons.first() {
            status.set_message(first);
        }
        if case.reasons.len() > 1 {
            status.set_description(case.reasons.join("\n"));
        }
    }
    let mut test = TestCase::new(&*case.name, status);
    test.set_classname(&*case.class).set_time(case.took);
    for (name, value) in &case.properties {
        test.add_property((*name, &**value));
    }
    if !case.output.is_empty() {
        test.set_system_out(&*case.output);
    }
    test
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_is_a_success_a_failure_an_error_or_skipped() {
        let cases = Status::ALL.map(|status| {
            let reasons = vec!["1 < 2 & \"so\"".to_owned(), "second".to_owned()];
            Case::of_run("x.toml", "x", &CaseResult::without_run("x.toml", status, reasons))
        });
        let xml = report("lashloop test", &cases, None).expect("XML");
        assert!(xml.contains(r#"tests="6" skipped="1" failures="1" errors="3""#), "{xml}");
        assert!(xml.contains(r#"message="1 &lt; 2 &amp; &quot;so&quot;" type="FAIL""#), "{xml}");
        assert_eq!(xml.matches("<testsuite ").count(), 1, "{xml}");
    }

    #[test]
    fn a_report_without_results_is_an_error_with_its_cause() {
        let xml = report("lashloop test", &[], Some("the drive was silent for 2.5 s")).expect("XML");
        assert!(xml.contains(r#"tests="1" skipped="0" failures="0" errors="1""#), "{xml}");
        assert!(xml.contains(r#"<error message="the drive was silent for 2.5 s"/>"#), "{xml}");
    }
}
