//! The results as a page for a browser, with a report of each record.

use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use lashloop_report::page::{Run, Suite, SuiteExpectation, SuiteRow};

use super::case_result::{CaseResult, Check, Status};
use super::plan::Case;
use super::tally::Tally;

const REPORT: &str = "report.html";

/// The index page as a value. `page` is its file: addresses of reports are relative to its folder.
#[must_use]
pub fn suite(tally: &Tally, page: &Path, command: String, wall_s: f64) -> Suite {
    let rows = tally.rows().map(|(case, result)| row(case, result, page)).collect();
    Suite { title: "Scenarios".to_owned(), command, wall_s, rows }
}

fn row(case: &Case, result: &CaseResult, page: &Path) -> SuiteRow {
    let setting = |setting: &String| {
        let (key, value) = setting.split_once('=').unwrap_or((setting, ""));
        (key.to_owned(), value.to_owned())
    };
    let is_verdict = !matches!(result.status, Status::BadScenario | Status::DeviceOrLink);
    let report = result.record.as_ref().map(|record| record.join(REPORT)).filter(|report| report.is_file());
    SuiteRow {
        name: case.file.display().to_string(),
        settings: case.settings.iter().map(setting).collect(),
        device: result.device.clone(),
        verdict: is_verdict.then(|| result.status.word().to_owned()),
        reason: result.reasons.join("; "),
        expectations: result.checks.iter().map(expectation).collect(),
        wall_s: result.wall_s,
        report: report.and_then(|report| relative(page, &report).ok()),
    }
}

fn expectation(check: &Check) -> SuiteExpectation {
    let Check { name, value, min, max, unit, ok } = check.clone();
    SuiteExpectation { name, value, min, max, unit, ok }
}

/// Writes the report of each record that was kept.
///
/// # Errors
/// A report can't be written.
pub fn write_reports(tally: &Tally) -> Result<(), ReportError> {
    for (case, result) in tally.rows() {
        let Some(record) = &result.record else { continue };
        // A drive that failed before the first step leaves no trace.
        let Ok(run) = Run::read(&*case.name, record) else { continue };
        let path = record.join(REPORT);
        let written = fs::write(&path, lashloop_report::page::run(&run));
        written.map_err(|source| ReportError { path, source })?;
    }
    Ok(())
}

/// A report that can't be written.
#[derive(Debug)]
pub struct ReportError {
    pub path: PathBuf,
    pub source: io::Error,
}

/// The address of a file for a link on a page.
fn relative(page: &Path, file: &Path) -> io::Result<String> {
    let folder = match page.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let (from, to) = (folder.canonicalize()?, file.canonicalize()?);
    let names = |path: &Path| {
        let normal = path.components().filter(|part| matches!(part, Component::Normal(_)));
        normal.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect::<Vec<_>>()
    };
    let (from, to) = (names(&from), names(&to));
    let common = from.iter().zip(&to).take_while(|(from, to)| from == to).count();
    let up = from[common..].iter().map(|_| "..".to_owned());
    let escape = |name: &String| name.replace('%', "%25").replace('#', "%23").replace('?', "%3F");
    Ok(up.chain(to[common..].iter().map(escape)).collect::<Vec<_>>().join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_leads_from_the_page_to_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for name in ["out/records/a #1", "pages"] {
            fs::create_dir_all(at(name)).expect("a folder");
        }
        let report = at("out/records/a #1/report.html");
        fs::write(&report, "").expect("a file");
        let address = |page: &str| relative(&at(page), &report).expect("an address");
        assert_eq!(address("out/index.html"), "records/a %231/report.html");
        assert_eq!(address("pages/index.html"), "../out/records/a %231/report.html");
    }
}
