//! `lashloop run --junit`: the verdict of one run as a JUnit report.

use std::fs;
use std::io;
use std::path::Path;

use lashloop_bench::verdict::Exit;

use super::error::CliError;
use crate::suite::case_result::{CaseResult, Status};
use crate::suite::junit::{self, Row};

const NAME: &str = "lashloop run";

/// Writes the report of a run with a verdict.
pub(super) fn write(path: &Path, result: &CaseResult) -> Result<(), CliError> {
    let row = Row { file: result.case.clone(), case: NAME.to_owned(), result };
    let written = junit::report(NAME, &[row], None).map_err(io::Error::other);
    written
        .and_then(|xml| fs::write(path, xml))
        .map_err(|source| CliError::Report { path: path.to_owned(), source })
}

/// Writes the report of a run without a verdict, in place of an earlier one that may have passed.
pub(super) fn write_error(path: &Path, error: &CliError) -> Result<(), CliError> {
    let status = match error.exit() {
        Exit::UsageOrScenario => Status::BadScenario,
        Exit::Fail => Status::Fail,
        Exit::Invalid => Status::Invalid,
        Exit::Pass | Exit::DeviceOrLink | Exit::HardwareAbsent => Status::DeviceOrLink,
    };
    write(path, &CaseResult::without_run(NAME, status, vec![error.to_string()]))
}
