//! Every case of a suite, in the order of its tables.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::digest;
use lashloop_bench::scenario::cases::Cases;
use lashloop_bench::scenario::sweep::Setting;
use lashloop_bench::scenario::{Override, Scenario, ScenarioErrors};
use lashloop_bench::timing::ClockName;
use lashloop_plant::Plants;
use lashloop_record::resolved;

use super::baseline::{Baseline, CaseBaseline, path_of};
use super::case_result::CaseResult;

/// A case of a suite.
#[derive(Debug)]
pub struct Case {
    /// The file, and what the case sets in it. It identifies the case.
    pub name: String,
    pub file: PathBuf,
    /// Settings of the sweep, each as `key=value`.
    pub settings: Vec<String>,
    /// What metrics are compared with; `None` while baselines are written.
    pub baseline: Option<CaseBaseline>,
    pub job: Job,
}

/// What there is to do for a case.
#[derive(Debug)]
pub enum Job {
    Run {
        scenario: Box<Scenario>,
        sha256: String,
    },
    /// Not for this device, and why.
    Skip(String),
    /// Every error of the scenario.
    Report(Vec<String>),
}

/// What the cases have in common.
pub struct Common<'a> {
    pub device: &'a DeviceChoice,
    pub clock: ClockName,
    pub overrides: &'a [Override],
    pub plants: &'a Plants,
    /// Compare metrics with baselines.
    pub compares: bool,
    /// Report a case that has neither an expectation nor a baseline, and don't run it.
    pub requires_expectations: bool,
}

impl Case {
    /// The result of a run with its metrics against the baseline.
    #[must_use]
    pub fn judged(&self, mut result: CaseResult) -> CaseResult {
        if let Some(baseline) = self.baseline.as_ref().filter(|_| result.status.is_verdict()) {
            let (checks, reasons) = baseline.check(&result.metrics);
            result.add_checks(checks, reasons);
        }
        result
    }

    /// Name of the record's folder: readable, and unique by the digest of the case's name. It depends on no other case, and as
    /// a single name it is in no other record.
    #[must_use]
    pub fn folder(&self) -> String {
        const LONGEST: usize = 80;
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let words = std::iter::once(&*stem).chain(self.settings.iter().map(String::as_str));
        let is_plain = |it: char| it.is_ascii_alphanumeric() || "._=+-".contains(it);
        let plain = |it: char| if is_plain(it) { it } else { '_' };
        let readable: String = words.collect::<Vec<_>>().join("_").chars().map(plain).take(LONGEST).collect();
        format!("{readable}-{}", &digest::sha256(self.name.as_bytes())[..12])
    }
}

/// The cases of these files. Equal cases of a sweep are one.
#[must_use]
pub fn cases(files: &[PathBuf], common: &Common<'_>) -> Vec<Case> {
    let mut names = HashSet::new();
    let all = files.iter().flat_map(|file| cases_of(file, common));
    all.filter(|case| names.insert(case.name.clone())).collect()
}

fn cases_of(file: &Path, common: &Common<'_>) -> Vec<Case> {
    // Without UTF-8, two names would be the same text: such a name is escaped.
    let name = file.to_str().map_or_else(|| format!("{file:?}"), str::to_owned);
    let case = |settings: Vec<String>, baseline, job| {
        let name =
            if settings.is_empty() { name.clone() } else { format!("{name}: {}", settings.join(", ")) };
        Case { name, file: file.to_owned(), settings, baseline, job }
    };
    let single = |job| vec![case(Vec::new(), None, job)];
    let read = match Cases::from_file(file, common.overrides, common.plants) {
        Ok(cases) => cases,
        Err(errors) => return single(report(&errors)),
    };
    let baseline = match Baseline::read(&path_of(file)) {
        Ok(baseline) => baseline.filter(|_| common.compares).unwrap_or_default(),
        Err(error) => return single(Job::Report(vec![error.to_string()])),
    };
    let swept = |row: &Vec<Setting>| {
        let settings: Vec<_> = row.iter().map(ToString::to_string).collect();
        let baseline = baseline.case(&settings).cloned();
        let job = read.scenario(row).map_or_else(
            |errors| report(&errors),
            |scenario| {
                if common.requires_expectations && scenario.expectations.is_empty() && baseline.is_none() {
                    let remedy = "give it an [[expect]], or a baseline by --update";
                    return Job::Report(vec![format!(
                        "{}: nothing is expected of it; {remedy}",
                        scenario.name
                    )]);
                }
                job(scenario, common)
            },
        );
        case(settings, baseline, job)
    };
    read.settings().iter().map(swept).collect()
}

fn report(errors: &ScenarioErrors) -> Job {
    Job::Report(errors.iter().map(ToString::to_string).collect())
}

fn job(scenario: Scenario, Common { device, clock, .. }: &Common<'_>) -> Job {
    if !scenario.run.mode.is_hil() {
        match device.for_run(&scenario, *clock) {
            Ok(device) if device.keeps_bench_clock(*clock) => {}
            _ => {
                return Job::Skip(format!(
                    "bench mode needs a drive with pins, and {device} has none in {clock}; --device silicon or \
                     --device inproc runs it"
                ));
            }
        }
    }
    // With the table of its reference.
    match resolved::files(&scenario) {
        Ok(files) => {
            let whole: String = files.into_iter().map(|(_, text)| text).collect();
            let sha256 = digest::sha256(whole.as_bytes());
            Job::Run { scenario: Box::new(scenario), sha256 }
        }
        Err(error) => Job::Report(vec![format!("{}: {error}", scenario.name)]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(file: &str, settings: &[&str]) -> String {
        let settings: Vec<_> = settings.iter().map(ToString::to_string).collect();
        let name = format!("{file}: {}", settings.join(", "));
        Case { name, file: file.into(), settings, baseline: None, job: Job::Skip(String::new()) }.folder()
    }

    #[test]
    fn the_folder_of_a_record_is_one_name_that_shows_its_case() {
        let swept = folder("s/gap.toml", &["plant.dead_zone_rad=0.2", "reference.file=../a b.csv"]);
        assert!(swept.starts_with("gap_plant.dead_zone_rad=0.2_reference.file=.._a_b.csv-"), "{swept}");
        assert_ne!(folder("a.toml", &[]), folder("./a.toml", &[]), "the whole name counts");
        assert_ne!(folder("a.toml", &["x=b/c"]), folder("a.toml", &["x=b_c"]), "its exact text, too");
        let long = folder("a.toml", &["\u{3bc}/".repeat(200).as_str()]);
        assert!(long.len() < 100 && !long.contains('/'), "{long}");
    }
}
