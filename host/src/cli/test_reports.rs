//! The reports of `lashloop test`: JUnit XML and the index page. None of an earlier suite stays.

use std::path::{Path, PathBuf};
use std::{fs, io};

use lashloop_bench::atomic_file::remove_if_present;
use lashloop_report::page;

use super::error::CliError;
use super::output::{error_line, write_file};
use crate::suite::index::{self, ReportError};
use crate::suite::junit::{self, Row};
use crate::suite::plan::Case;
use crate::suite::tally::Tally;

const NAME: &str = "lashloop test";

/// Removes reports of an earlier suite: a suite that is killed leaves none. A device such as /dev/stdout is no report.
pub(super) fn remove<'a>(reports: impl Iterator<Item = &'a PathBuf>) -> Result<(), CliError> {
    let is_file = |path: &&PathBuf| fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
    reports.filter(is_file).try_for_each(|report| Ok(remove_if_present(report)?))
}

pub(super) fn write_junit(path: &Path, tally: &Tally<'_>) -> Result<(), CliError> {
    let row = |(case, result): (&Case, _)| {
        let Case { file, settings, .. } = case;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let case = if settings.is_empty() { stem } else { settings.join(", ") };
        Row { file: file.display().to_string(), case, result }
    };
    let rows: Vec<_> = tally.rows().map(row).collect();
    write_xml(path, &rows, tally.shortfall().as_deref())
}

/// Writes the JUnit report of a suite that ended with an error.
pub(super) fn write_error(path: &Path, error: &CliError) -> Result<(), CliError> {
    write_xml(path, &[], Some(&error.to_string()))
}

fn write_xml(path: &Path, rows: &[Row<'_>], shortfall: Option<&str>) -> Result<(), CliError> {
    let xml = junit::report(NAME, rows, shortfall).map_err(io::Error::other);
    let written = xml.and_then(|xml| fs::write(path, xml));
    written.map_err(|source| CliError::Report { path: path.to_owned(), source })
}

/// Writes the index page, and a report of each record.
pub(super) fn write_page(path: &Path, tally: &Tally<'_>, wall_s: f64) -> Result<(), CliError> {
    let unreadable = index::write_reports(tally)
        .map_err(|ReportError { path, source }| CliError::Output { path, source })?;
    for error in unreadable {
        error_line(format_args!("no report of a record: {error}"));
    }
    let command = lashloop_record::source::command_line();
    write_file(path, &page::suite(&index::suite(tally, path, command, wall_s)))
}
