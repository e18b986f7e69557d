//! The reports of `lashloop test`: JUnit XML and the index page. None of an earlier suite stays.

use std::path::{Path, PathBuf};

use lashloop_bench::atomic_file::remove_if_present;
use lashloop_report::junit::Case as JunitCase;
use lashloop_report::{page, suite_reports};

use crate::error::CliError;
use crate::output::warn;
use crate::report_files::{check, is_replaced, write, write_junit};
use lashloop_campaign::suite::plan::Case;
use lashloop_campaign::suite::tally::Tally;

const NAME: &str = "lashloop test";

/// The files of the reports.
pub(super) struct TestReports<'a> {
    pub(super) junit: Option<&'a Path>,
    pub(super) html: Option<&'a Path>,
}

impl TestReports<'_> {
    /// Checks that no report would replace a scenario of the suite or a file of a record.
    pub(super) fn check(&self, scenarios: &[PathBuf]) -> Result<(), CliError> {
        [self.junit, self.html].into_iter().flatten().try_for_each(|report| check(report, scenarios))
    }

    /// Replaces the reports of an earlier suite by those of one without results: a suite that is killed is INCOMPLETE.
    pub(super) fn begin(&self, tally: &Tally<'_>) -> Result<(), CliError> {
        if let Some(path) = self.junit.filter(|path| is_replaced(path)) {
            write_tally(path, tally)?;
        }
        self.html.filter(|path| is_replaced(path)).map_or(Ok(()), |path| write_index(path, tally, 0.0))
    }

    /// Writes the index page with a report of each record, and the JUnit report.
    pub(super) fn finish(&self, tally: &Tally<'_>, wall_s: f64) -> Result<(), CliError> {
        if let Some(path) = self.html {
            for error in suite_reports::write_reports(tally)? {
                warn(format_args!("no report of a record: {error}"));
            }
            write_index(path, tally, wall_s)?;
        }
        self.junit.map_or(Ok(()), |path| write_tally(path, tally))
    }

    /// Reports a suite that ended with an error. That a report can't be written does not hide the error.
    pub(super) fn fail(&self, error: &CliError) {
        let junit = self.junit.map(|path| write_junit(path, NAME, &[], Some(&error.to_string())));
        let page = self.html.filter(|path| path.is_file()).map(|path| Ok(remove_if_present(path)?));
        for error in junit.into_iter().chain(page).filter_map(Result::err) {
            warn(format_args!("{error}"));
        }
    }
}

fn write_tally(path: &Path, tally: &Tally<'_>) -> Result<(), CliError> {
    let row = |(case, result): (&Case, _)| {
        let Case { file, settings, .. } = case;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let case = if settings.is_empty() { stem } else { settings.join(", ") };
        JunitCase::of_run(&file.display().to_string(), &case, result)
    };
    let rows: Vec<_> = tally.rows().map(row).collect();
    write_junit(path, NAME, &rows, tally.shortfall().as_deref())
}

fn write_index(path: &Path, tally: &Tally<'_>, wall_s: f64) -> Result<(), CliError> {
    let command = lashloop_record::source::command_line();
    write(path, "--html", &page::suite(&suite_reports::suite(tally, path, command, wall_s)))
}
