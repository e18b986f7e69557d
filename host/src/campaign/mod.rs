//! Control laws on plants outside their tuning: many runs, in process and in parallel, and their statistics.
//!
//! | module | is |
//! |---|---|
//! | [`law`], [`case`] | the laws under test, and one run and its result |
//! | [`plants`], [`sweeps`] | random plants, and the nominal one with one quantity varied |
//! | [`plan`] | all cases of a campaign |
//! | [`runs`] | runs the cases |
//! | [`journal`] | what a journal belongs to |
//! | [`score`], [`quantiles`] | criteria of a run, and quantiles over runs |
//! | [`limits`] | limits on the random plants |
//! | [`report`], [`table`] | the tables as text, JSON and CSV |
//!
//! A run that diverges, latches a fault or never settles has no value, which ranks behind every value. Such a run is counted,
//! stays in every quantile, and misses every limit on a quantile that includes it.

pub mod case;
mod error;
pub mod journal;
pub mod law;
pub mod limits;
mod names;
pub mod plan;
pub mod plants;
pub mod quantiles;
pub mod report;
pub mod runs;
pub mod score;
pub mod sweeps;
pub mod table;

use std::collections::BTreeMap;
use std::num::NonZeroUsize;

use lashloop_bench::scenario::ScenarioErrors;
use lashloop_bench::supervisor::Supervisor;

use crate::journal::JournalError;
use crate::workers::Ended;
use case::{Case, CaseId, CaseResult};
pub use error::CampaignError;
use plan::Settings;
use report::Report;

/// The cases of a campaign and their results so far.
#[derive(Debug)]
pub struct Campaign {
    settings: Settings,
    cases: Vec<Case>,
    /// In the order of the tables.
    results: BTreeMap<CaseId, CaseResult>,
}

impl Campaign {
    /// A campaign without results.
    ///
    /// # Errors
    /// A scenario refuses a setting of its case.
    pub fn new(settings: Settings) -> Result<Self, ScenarioErrors> {
        let cases = plan::cases(&settings)?;
        Ok(Self { settings, cases, results: BTreeMap::new() })
    }

    /// Number of cases.
    #[must_use]
    pub fn total(&self) -> usize {
        self.cases.len()
    }

    /// Number of results so far.
    #[must_use]
    pub fn done(&self) -> usize {
        self.results.len()
    }

    /// Adds a result from the journal.
    ///
    /// # Errors
    /// The campaign lacks its case, or already has a result for it.
    pub fn take(&mut self, result: CaseResult) -> Result<(), &'static str> {
        if !self.cases.iter().any(|case| case.id == result.case) {
            return Err("the result of a run that is not part of this battery");
        }
        match self.results.insert(result.case, result) {
            None => Ok(()),
            Some(_) => Err("a second result of a run"),
        }
    }

    /// Runs the cases without a result. Each result passes through `keep` first.
    ///
    /// # Errors
    /// A run or `keep` fails.
    pub fn run(
        &mut self,
        jobs: NonZeroUsize,
        supervisor: &Supervisor,
        mut keep: impl FnMut(&CaseResult) -> Result<(), JournalError>,
    ) -> Result<Ended, CampaignError> {
        let Self { cases, results, .. } = self;
        let missing: Vec<_> = cases.iter().filter(|case| !results.contains_key(&case.id)).collect();
        runs::run_all(&missing, jobs, supervisor, |result| {
            keep(&result)?;
            results.insert(result.case, result);
            Ok(())
        })
    }

    /// Cases with their results, in the order of the tables.
    pub fn results(&self) -> impl Iterator<Item = (&Case, &CaseResult)> {
        self.cases.iter().filter_map(|case| Some((case, self.results.get(&case.id)?)))
    }

    /// The report on the results so far.
    #[must_use]
    pub fn report(&self) -> Report {
        Report::new(&self.settings, self.results.values())
    }
}
