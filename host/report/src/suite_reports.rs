//! The results of a suite as a page for a browser, with a report of each record.

use std::io::{self, ErrorKind, Write};
use std::path::{Component, Path};

use lashloop_bench::atomic_file::{WriteError, write_whole};
use lashloop_campaign::suite::case_result::CaseResult;
use lashloop_campaign::suite::plan::Case;
use lashloop_campaign::suite::tally::Tally;
use lashloop_record::file_names::REPORT_FILE;
use lashloop_record::reader::{ReadError, ReadFault};

use crate::page::{Run, Suite, SuiteRow};

/// The index page as a value. `page` is its file: addresses of reports are relative to its folder.
#[must_use]
pub fn suite(tally: &Tally<'_>, page: &Path, command: Vec<String>, wall_s: f64) -> Suite {
    let rows = tally.all().map(|(case, result)| row(case, result, page)).collect();
    let sentence = |clause: String| clause[..1].to_uppercase() + &clause[1..] + ".";
    let (title, verdict) = ("Scenarios".to_owned(), tally.conclusion().word().to_owned());
    Suite { title, verdict, reason: tally.shortfall().map(sentence), command, wall_s, rows }
}

fn row(case: &Case, result: Option<&CaseResult>, page: &Path) -> SuiteRow {
    let setting = |setting: &String| {
        let (key, value) = setting.split_once('=').unwrap_or((setting, ""));
        (key.to_owned(), value.to_owned())
    };
    let row = SuiteRow {
        name: case.file.display().to_string(),
        settings: case.settings.iter().map(setting).collect(),
        verdict: "NOT RUN".to_owned(),
        ..SuiteRow::default()
    };
    let Some(result) = result else { return row };
    let report =
        result.record.as_ref().map(|record| record.join(REPORT_FILE)).filter(|report| report.is_file());
    SuiteRow {
        device: result.device.clone(),
        verdict: result.status.word().to_owned(),
        reason: result.reasons.join("; "),
        checks: result.checks.clone(),
        wall_s: result.wall_s,
        report: report.and_then(|report| relative(page, &report).ok()),
        ..row
    }
}

/// Writes the report of each record that was kept. Returns the records that can't be read, which have none.
///
/// # Errors
/// A report can't be written.
pub fn write_reports(tally: &Tally<'_>) -> Result<Vec<ReadError>, WriteError> {
    let mut unreadable = Vec::new();
    for (case, result) in tally.rows() {
        let Some(record) = &result.record else { continue };
        let run = match Run::read(&*case.name, record) {
            Ok(run) => run,
            // A drive that failed before the first step leaves no trace.
            Err(ReadError {
                fault: ReadFault::Empty | ReadFault::NoRecord | ReadFault::NoFolder, ..
            }) => continue,
            Err(ReadError { fault: ReadFault::Read(error), .. }) if error.kind() == ErrorKind::NotFound => {
                continue;
            }
            Err(error) => {
                unreadable.push(error);
                continue;
            }
        };
        let text = crate::page::run(&run, &crate::page::Panels::default());
        write_whole(&record.join(REPORT_FILE), ".report-", |file| file.write_all(text.as_bytes()))?;
    }
    Ok(unreadable)
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
    use std::fs;

    use super::*;
    use lashloop_campaign::suite::case_result::Status;
    use lashloop_campaign::suite::plan::Job;

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

    #[test]
    fn a_record_that_can_not_be_read_is_reported_and_an_empty_one_is_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let case = |name: &str| Case {
            name: name.to_owned(),
            file: name.into(),
            settings: Vec::new(),
            baseline: None,
            job: Job::Skip(String::new()),
        };
        let cases = ["empty", "damaged"].map(case);
        let mut tally = Tally::new(&cases);
        for case in &cases {
            let record = folder.path().join(&case.name);
            fs::create_dir(&record).expect("a folder");
            let result = CaseResult::without_run(&case.name, Status::DeviceOrLink, Vec::new());
            tally.add(CaseResult { record: Some(record), ..result });
        }
        fs::write(folder.path().join("damaged/record.json"), "{").expect("a manifest");
        let unreadable = write_reports(&tally).expect("nothing is written");
        let errors: Vec<_> = unreadable.iter().map(ToString::to_string).collect();
        assert!(
            errors.len() == 1 && errors[0].contains("damaged/record.json: is not the manifest"),
            "{errors:?}"
        );
    }
}
