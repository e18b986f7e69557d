//! Records of the worst runs and of failures, and any row run again. A run that is repeated must give the same torques.

use std::fs;
use std::path::{Path, PathBuf};

use csv::StringRecord;
use lashloop::execution::{Execution, ExecutionError};
use lashloop_bench::atomic_file::remove_if_present;
use lashloop_bench::device::DeviceChoice;
use lashloop_bench::run::End;
use lashloop_bench::supervisor::Supervisor;
use lashloop_record::file_names::LATEST;
use lashloop_record::folder::RecordFolder;
use lashloop_record::source::RunSource;
use lashloop_record::writer::RecordWriter;

use crate::campaign::Campaign;
use crate::cell::{Cell, Missing};
use crate::error::CampaignError;
use crate::plan::Case;
use crate::row::{CaseResult, Columns, LAST};
use crate::run::{NO_RUN, result_of, run_case};
use crate::table::Table;
use crate::workers::Stop;

/// Folder of the records, in that of the results.
pub const EVIDENCE: &str = "evidence";

/// A row that is run again.
#[derive(Debug, Clone, PartialEq)]
pub struct Pick {
    pub case: u64,
    /// The fields of the row.
    pub row: StringRecord,
}

impl Pick {
    #[must_use]
    pub fn is_failure(&self) -> bool {
        self.row.get(self.row.len().saturating_sub(LAST.len())) != Some(PASS)
    }

    fn has_run(&self) -> bool {
        let end = self.row.get(self.row.len().saturating_sub(2));
        end.is_none_or(|end| !end.starts_with(NO_RUN))
    }
}

/// The verdict of a run that isn't a failure.
const PASS: &str = "PASS";

/// What runs cases again.
pub struct Repeater<'a> {
    pub campaign: &'a Campaign,
    pub device: &'a DeviceChoice,
    pub supervisor: &'a Supervisor,
}

/// The rows whose records are kept: the worst ones, then failures in the order of cases, each once; none without a run.
///
/// # Errors
/// The table can't be read, or is not that of its campaign.
pub fn picks(table: &Table<'_>) -> Result<Vec<Pick>, CampaignError> {
    let settings = &table.campaign.file.evidence;
    let of = table.columns.numbers.iter().position(|name| Some(name) == settings.of.as_ref());
    // The worst first; of equals the first case.
    let mut worst: Vec<(Cell, Pick)> = Vec::new();
    let mut failures = Vec::new();
    if settings.worst == 0 && settings.failures == 0 {
        return Ok(failures);
    }
    table.for_each(|row| {
        if row.end().starts_with(NO_RUN) {
            return Ok(());
        }
        let pick = || Pick { case: row.case, row: row.fields().clone() };
        let cell = of.and_then(|column| row.cell(column));
        if let Some(cell) =
            cell.filter(|cell| !matches!(cell, Cell::Missing(Missing::Unmeasured | Missing::Omitted)))
        {
            let cell = cell.magnitude();
            let place = worst.partition_point(|(worse, _)| worse.order(&cell).is_ge());
            if (place as u64) < settings.worst {
                worst.insert(place, (cell, pick()));
                worst.truncate(settings.worst as usize);
            }
        }
        if row.verdict() != PASS && (failures.len() as u64) < settings.failures {
            failures.push(pick());
        }
        Ok(())
    })?;
    let mut picks: Vec<_> = worst.into_iter().map(|(_, pick)| pick).collect();
    failures.retain(|failure| !picks.contains(failure));
    picks.append(&mut failures);
    Ok(picks)
}

/// The row of a case.
///
/// # Errors
/// The table can't be read, or the campaign has no such case.
pub fn pick(table: &Table<'_>, case: u64) -> Result<Pick, CampaignError> {
    table.campaign.case(case)?;
    let mut found = StringRecord::new();
    table.for_each(|row| {
        if row.case == case {
            found = row.fields().clone();
        }
        Ok(())
    })?;
    Ok(Pick { case, row: found })
}

/// Folder of a case's record.
#[must_use]
pub fn folder_of(results: &Path, case: u64) -> PathBuf {
    results.join(EVIDENCE).join(format!("case-{case:06}"))
}

impl Repeater<'_> {
    /// Runs a row again and keeps its record among the evidence, instead of an older one; `None` if the user stopped it.
    ///
    /// # Errors
    /// As [`repeat`](Self::repeat), or the folder of the record has files of the user.
    pub fn keep(&self, pick: &Pick, results: &Path) -> Result<Option<CaseResult>, CampaignError> {
        let folder = folder_of(results, pick.case);
        let result = self.repeat(pick, Some(RecordFolder::claim(&folder, true)?));
        // Users don't look for the last of several records.
        let latest = folder.with_file_name(LATEST);
        if fs::read_link(&latest).is_ok_and(|target| Some(target.as_os_str()) == folder.file_name()) {
            remove_if_present(&latest)?;
        }
        result
    }

    /// Runs a row again, with a record if a folder is given, and compares it with the table; `None` if the user stopped it.
    /// A row without a run has no record.
    ///
    /// # Errors
    /// The run fails, the record can't be written, or the row differs.
    pub fn repeat(
        &self,
        pick: &Pick,
        record: Option<RecordFolder>,
    ) -> Result<Option<CaseResult>, CampaignError> {
        let case = self.campaign.case(pick.case)?;
        let stop = Stop::new(self.supervisor);
        let result = match record.filter(|_| pick.has_run()) {
            Some(folder) => self.recorded(&case, folder, &stop)?,
            None => run_case(self.campaign, self.device, pick.case, &stop)?.map(|(_, result)| result),
        };
        let Some(result) = result else { return Ok(None) };
        let columns = Columns::of(self.campaign);
        let again = columns.fields(self.campaign, &case, &result);
        // End and torques first: other differences usually follow from them.
        let last = columns.len() - 1;
        let places = [last - 1, last].into_iter().chain(0..columns.len());
        for place in places {
            let (before, again) = (&pick.row[place], &again[place]);
            if before != again {
                let column = columns.name(place).to_owned();
                let (before, again) = (before.to_owned(), again.to_owned());
                return Err(CampaignError::NotRepeated { case: pick.case, column, before, again });
            }
        }
        Ok(Some(result))
    }

    fn recorded(
        &self,
        case: &Case,
        folder: RecordFolder,
        stop: &Stop<'_>,
    ) -> Result<Option<CaseResult>, CampaignError> {
        let scenario = self.campaign.scenario(case)?;
        let failed =
            |source: ExecutionError| CampaignError::Run { case: case.number, source: Box::new(source) };
        let source = Path::new(&self.campaign.scenario_source(case).path);
        let overrides = self.campaign.overrides(case);
        folder.check_source(source)?;
        let writer = RecordWriter::new(folder, RunSource::new(source, &overrides, self.campaign.plants()));
        let mut stopper = stop;
        let execution = Execution::new(scenario, self.device.into()).watch(&mut stopper).record(writer);
        let made = execution.run(self.supervisor).map_err(failed)?;
        if made.outcome.end == End::Interrupted {
            return Ok(None);
        }
        let outcome = made.finish()?.outcome;
        Ok(Some(result_of(self.campaign, case, outcome)))
    }
}
