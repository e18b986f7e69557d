//! `lashloop run --junit`: the verdict of one run as a JUnit report.

use std::path::Path;

use lashloop_bench::verdict::Exit;

use super::error::CliError;
use super::output::warn;
use super::report_files::{is_replaced, write_junit};
use lashloop_campaign::suite::case_result::{CaseResult, Status};
use lashloop_report::junit::Case;

const NAME: &str = "lashloop run";

/// Replaces an earlier report, which may have passed: a run that is killed leaves an error.
pub(super) fn begin(path: &Path) -> Result<(), CliError> {
    let result =
        || CaseResult::without_run(NAME, Status::DeviceOrLink, vec!["the run has not ended".to_owned()]);
    if is_replaced(path) { write(path, &result()) } else { Ok(()) }
}

/// Writes the report of a run with a verdict.
pub(super) fn write(path: &Path, result: &CaseResult) -> Result<(), CliError> {
    write_junit(path, NAME, &[Case::of_run(&result.case, NAME, result)], None)
}

/// Writes the report of a run without a verdict. That it can't be written does not hide the error.
pub(super) fn write_error(path: &Path, error: &CliError) {
    let status = match error.exit() {
        Exit::UsageOrScenario => Status::BadScenario,
        Exit::Fail => Status::Fail,
        Exit::Invalid => Status::Invalid,
        Exit::Pass | Exit::DeviceOrLink | Exit::HardwareAbsent => Status::DeviceOrLink,
    };
    if let Err(error) = write(path, &CaseResult::without_run(NAME, status, vec![error.to_string()])) {
        warn(format_args!("{error}"));
    }
}
