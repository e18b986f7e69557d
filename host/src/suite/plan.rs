//! Every case of a suite, in the order of its tables.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::digest;
use lashloop_bench::scenario::cases::Cases;
use lashloop_bench::scenario::sweep::Setting;
use lashloop_bench::scenario::{Override, Scenario, ScenarioErrors};
use lashloop_bench::timing::ClockName;
use lashloop_plant::Plants;

use super::baseline::{Baseline, CaseBaseline, path_of};

/// A case of a suite.
#[derive(Debug, Clone)]
pub struct Case {
    /// The file, and what the case sets in it. It identifies the case.
    pub name: String,
    pub file: PathBuf,
    /// Settings of the sweep, each as `key=value`.
    pub settings: Vec<String>,
    /// Folder of the record, relative to that of all records.
    pub folder: PathBuf,
    pub baseline: Option<CaseBaseline>,
    pub job: Job,
}

/// What there is to do for a case.
#[derive(Debug, Clone)]
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
}

/// The cases of these files.
#[must_use]
pub fn cases(files: &[PathBuf], common: &Common<'_>) -> Vec<Case> {
    let mut folders = BTreeSet::new();
    let mut cases = Vec::new();
    for file in files {
        for case in cases_of(file, common) {
            let folder = unused(case.folder, &mut folders);
            cases.push(Case { folder, ..case });
        }
    }
    cases
}

fn cases_of(file: &Path, common: &Common<'_>) -> Vec<Case> {
    let name = file.display().to_string();
    let folder = folder_of(file);
    let single = |job| {
        let (name, folder) = (name.clone(), folder.clone());
        vec![Case { name, file: file.to_owned(), settings: Vec::new(), folder, baseline: None, job }]
    };
    let read = match Cases::from_file(file, common.overrides, common.plants) {
        Ok(cases) => cases,
        Err(errors) => return single(report(&errors)),
    };
    let baseline = match Baseline::read(&path_of(file)) {
        Ok(baseline) => baseline.unwrap_or_default(),
        Err(error) => return single(Job::Report(vec![error.to_string()])),
    };
    let count = read.settings().len();
    let case = |(number, row): (usize, &Vec<Setting>)| {
        let settings: Vec<_> = row.iter().map(ToString::to_string).collect();
        let is_swept = !settings.is_empty();
        let (mut name, mut folder) = (name.clone(), folder.clone());
        if is_swept {
            name = format!("{name}: {}", settings.join(", "));
            let digits = count.to_string().len();
            folder.as_mut_os_string().push(format!(".{number:0digits$}"));
        }
        let baseline = baseline.case(&settings).cloned();
        let job = read.scenario(row).map_or_else(|errors| report(&errors), |scenario| job(scenario, common));
        Case { name, file: file.to_owned(), settings, folder, baseline, job }
    };
    (1..).zip(read.settings()).map(case).collect()
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
    match scenario.to_toml() {
        Ok(text) => {
            let sha256 = digest::sha256(text.as_bytes());
            Job::Run { scenario: Box::new(scenario), sha256 }
        }
        Err(error) => Job::Report(vec![format!("{}: {error}", scenario.name)]),
    }
}

/// The path of a file without its ending and without what leads out of a folder.
fn folder_of(file: &Path) -> PathBuf {
    let names = file.components().filter(|part| matches!(part, Component::Normal(_)));
    names.collect::<PathBuf>().with_extension("")
}

/// The folder, with a number if an earlier case has it.
fn unused(folder: PathBuf, used: &mut BTreeSet<PathBuf>) -> PathBuf {
    let numbered = |number: u32| {
        let mut folder = folder.clone();
        folder.as_mut_os_string().push(format!("-{number}"));
        folder
    };
    let mut names = std::iter::once(folder.clone()).chain((2..).map(numbered));
    let free = names.find(|name| !used.contains(name)).expect("numbers do not end");
    used.insert(free.clone());
    free
}
