//! The files of `--junit` and `--html`: none replaces a user's file, and an earlier PASS does not outlive the start.

use std::path::{Path, PathBuf};
use std::{fs, io};

use lashloop_record::folder::RecordFolder;

use super::error::CliError;
use super::output::write_file;
use lashloop_campaign::suite::baseline;
use lashloop_report::junit::{self, Case};

/// Checks that a report would replace neither a file of a record nor one of these scenarios with its baseline.
pub(super) fn check(report: &Path, scenarios: &[PathBuf]) -> Result<(), CliError> {
    RecordFolder::check_output(report)?;
    let Ok(place) = report.canonicalize() else { return Ok(()) };
    let is_place = |path: &Path| path.canonicalize().is_ok_and(|it| it == place);
    match scenarios.iter().any(|it| is_place(it) || is_place(&baseline::path_of(it))) {
        true => Err(CliError::ReportOverInput { path: report.to_owned() }),
        false => Ok(()),
    }
}

/// Whether a report can say at the start that it has no result yet. A device such as /dev/stdout gets the result alone.
pub(super) fn is_replaced(report: &Path) -> bool {
    fs::metadata(report).map_or(true, |found| found.is_file() || found.is_dir())
}

pub(super) fn write_junit(
    path: &Path,
    name: &str,
    cases: &[Case],
    shortfall: Option<&str>,
) -> Result<(), CliError> {
    let xml = junit::report(name, cases, shortfall).map_err(io::Error::other);
    let failed = |source| CliError::Report { path: path.to_owned(), option: "--junit", source };
    xml.map_err(failed).and_then(|xml| write(path, "--junit", &xml))
}

/// Writes a report, whole.
pub(super) fn write(path: &Path, option: &'static str, text: &str) -> Result<(), CliError> {
    write_file(path, text).map_err(|error| match error {
        CliError::Output { path, source } => CliError::Report { path, option, source },
        other => other,
    })
}
