//! One case on a drive, with its record.

use std::path::Path;
use std::{fs, io};

use lashloop::execution::{Execution, ExecutionError, Finished};
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::{Clock, End, Outcome, RunError};
use lashloop_bench::scenario::{Override, Scenario};
use lashloop_bench::verdict::Exit;
use lashloop_plant::Plants;
use lashloop_record::file_names::LATEST;
use lashloop_record::folder::{FolderError, RecordFolder};
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;

use super::case_result::{CaseResult, Status};
use super::plan::{Case, Job};
use crate::workers::Stop;

/// How the cases are run.
pub struct Runner<'a> {
    pub device: &'a DeviceChoice,
    pub clock: Clock,
    /// Folder for records; `None` keeps none.
    pub records: Option<&'a Path>,
    /// Keep the records of passes too.
    pub keeps_passes: bool,
    /// Settings of every scenario, for the record.
    pub overrides: &'a [Override],
    pub plants: &'a Plants,
}

impl Runner<'_> {
    /// Runs a case; `None` if it was stopped. The record depends on the baseline, the result does not.
    ///
    /// # Errors
    /// The record can't be written. Every other error is a result.
    pub fn run(&self, case: &Case, stop: &Stop<'_>) -> Result<Option<CaseResult>, WriteError> {
        let Job::Run { scenario, sha256 } = &case.job else { return Ok(None) };
        let folder = self.records.map(|records| records.join(case.folder()));
        let record = folder.as_deref().map(|folder| self.open_record(folder, case)).transpose()?;
        let result = match self.run_scenario(scenario, record, stop) {
            Ok((_, outcome)) if outcome.end == End::Interrupted => None,
            // A signal to the whole group of processes ends drives too.
            Err(_) if stop.asked() => None,
            Err(ExecutionError::Run(RunError::Record(error))) => return Err(error),
            Ok((device, outcome)) => Some(CaseResult::of_run(&case.name, device, &outcome)),
            Err(error) => {
                let status = match error.exit() {
                    Exit::UsageOrScenario => Status::BadScenario,
                    _ => Status::DeviceOrLink,
                };
                Some(CaseResult::without_run(&case.name, status, vec![error.to_string()]))
            }
        };
        let has_passed = |result: &CaseResult| case.judged(result.clone()).status == Status::Pass;
        let is_kept = result.as_ref().is_some_and(|result| self.keeps_passes || !has_passed(result));
        if let Some(folder) = &folder {
            // Users don't look for the last run of several at once.
            let _ = fs::remove_file(folder.with_file_name(LATEST));
            // A drive that was never reached leaves an empty folder.
            let is_empty = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
            if is_empty || !is_kept {
                remove(folder)?;
            }
        }
        let record = folder.filter(|folder| folder.exists());
        Ok(result.map(|result| CaseResult { scenario_sha256: Some(sha256.clone()), record, ..result }))
    }

    /// The writer of a case's record, instead of the record of an interrupted run.
    fn open_record(&self, path: &Path, case: &Case) -> Result<RecordWriter, WriteError> {
        remove(path)?;
        let folder = RecordFolder::claim(path, true).map_err(|error| match error {
            FolderError::Create { path, source } => WriteError { path, action: "created", source },
            other => WriteError { path: path.to_owned(), action: "created", source: io::Error::other(other) },
        })?;
        let swept = case.settings.iter().cloned().map(Override::Set);
        let overrides: Vec<_> = self.overrides.iter().cloned().chain(swept).collect();
        Ok(RecordWriter::new(folder, RunSource::new(&case.file, &overrides, self.plants)))
    }

    /// Runs a scenario. Also returns what ran as the drive.
    fn run_scenario(
        &self,
        scenario: &Scenario,
        record: Option<RecordWriter>,
        stop: &Stop<'_>,
    ) -> Result<(String, Outcome), ExecutionError> {
        let mut stopper = stop;
        let execution = Execution::new(scenario.clone(), self.device.into()).clock(self.clock);
        let made = execution.watch(&mut stopper).record(record).run(stop.supervisor)?;
        let Finished { outcome, summary, .. } = made.finish()?;
        Ok((summary.device, outcome))
    }
}

fn remove(folder: &Path) -> Result<(), WriteError> {
    match fs::remove_dir_all(folder) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(WriteError { path: folder.to_owned(), action: "removed", source })
        }
        _ => Ok(()),
    }
}
