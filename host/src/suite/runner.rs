//! One case on a drive, with its record.

use std::path::{Path, PathBuf};
use std::{fs, io};

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::Device;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::{
    self, Clock, DeviceUnderTest, End, Outcome, RunError, RunStart, Step, StepObserver,
};
use lashloop_bench::scenario::Scenario;

use super::case_result::{CaseResult, Status};
use super::plan::{Case, Job};
use super::record::CaseRecord;
use crate::error::exit_of;
use crate::workers::Stop;
use lashloop_bench::verdict::Exit;
use lashloop_record::summary::Summary;

/// How the cases are run.
pub struct Runner<'a> {
    pub device: &'a DeviceChoice,
    pub clock: Clock,
    /// Folder for records; `None` keeps none.
    pub records: Option<&'a Path>,
    /// Keep the records of passes too.
    pub keeps_passes: bool,
    /// The summary of a run.
    pub summary: fn(&Scenario, &Device, &Outcome) -> Summary,
    /// Compare metrics with baselines.
    pub compares: bool,
}

impl Runner<'_> {
    /// Runs a case; `None` if it was stopped.
    ///
    /// # Errors
    /// The record can't be written. Every other error is a result.
    pub fn run(&self, case: &Case, stop: &Stop<'_>) -> Result<Option<CaseResult>, WriteError> {
        let Job::Run { scenario, sha256 } = &case.job else { return Ok(None) };
        let folder = self.records.map(|records| records.join(&case.folder));
        if let Some(folder) = &folder {
            renew(folder)?;
        }
        let result = match self.run_scenario(scenario, folder.as_deref(), stop) {
            Ok((_, outcome)) if outcome.end == End::Interrupted => None,
            // A signal to the whole group of processes ends drives too.
            Err(_) if stop.asked() => None,
            Err(RunError::Record(error)) => return Err(error),
            Ok((device, outcome)) => {
                let mut result = CaseResult::of_run(&case.name, device, &outcome);
                if let Some(baseline) = case.baseline.as_ref().filter(|_| self.compares) {
                    let (checks, reasons) = baseline.check(&result.metrics);
                    result.add_checks(checks, reasons);
                }
                Some(result)
            }
            Err(error) => {
                let status = match exit_of(&error) {
                    Exit::UsageOrScenario => Status::BadScenario,
                    _ => Status::DeviceOrLink,
                };
                Some(CaseResult::without_run(&case.name, status, vec![error.to_string()]))
            }
        };
        let is_kept = result.as_ref().is_some_and(|it| self.keeps_passes || it.status != Status::Pass);
        let record = folder.filter(|folder| {
            // A drive that was never reached leaves an empty folder.
            let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
            is_kept && !is_empty
        });
        if let (None, Some(records)) = (&record, self.records) {
            remove(&records.join(&case.folder))?;
        }
        Ok(result.map(|result| CaseResult { scenario_sha256: Some(sha256.clone()), record, ..result }))
    }

    /// Runs a scenario. Also returns what ran as the drive.
    fn run_scenario(
        &self,
        scenario: &Scenario,
        folder: Option<&Path>,
        stop: &Stop<'_>,
    ) -> Result<(String, Outcome), RunError> {
        let mut device =
            DeviceUnderTest::open(scenario, self.device, self.clock.name(), stop.supervisor, |link| link)?;
        let record = folder.map(|folder| CaseRecord::new(folder.to_owned()));
        let mut observer = Observer { stop, record };
        let outcome = run::run(scenario, &mut device, self.clock, &mut observer)?;
        if let Some(record) = observer.record {
            record.finish(&(self.summary)(scenario, &device.device, &outcome))?;
        }
        Ok((device.device.description(), outcome))
    }
}

struct Observer<'a> {
    stop: &'a Stop<'a>,
    record: Option<CaseRecord>,
}

impl StepObserver for Observer<'_> {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        self.record.as_mut().map_or(Ok(()), |record| record.begin(start))
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.record.as_mut().map_or(Ok(()), |record| record.step(step))
    }

    fn stop_asked(&self) -> bool {
        self.stop.asked()
    }
}

/// Makes an empty folder, in place of the record of an interrupted run.
fn renew(folder: &Path) -> Result<(), WriteError> {
    remove(folder)?;
    fs::create_dir_all(folder).map_err(failed(folder, "created"))
}

fn remove(folder: &Path) -> Result<(), WriteError> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(failed(folder, "removed")(error)),
        _ => Ok(()),
    }
}

fn failed(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> WriteError {
    let path: PathBuf = path.to_owned();
    move |source| WriteError { path, action, source }
}
