//! How control laws fare on plants they were not tuned for: many runs, in process and in parallel, and what they have in common.
//!
//! | module | is |
//! |---|---|
//! | [`plants`], [`sweeps`] | what is varied |
//! | [`plan`] | which runs there are |
//! | [`runs`] | makes them |
//! | [`journal`] | keeps each result as it comes |
//! | [`score`], [`spread`] | figures of a run, and over runs |
//! | [`limits`] | what has to come out |
//! | [`report`], [`table`] | what came out |
//!
//! A run that diverges, latches a fault or never settles has no figure, and that is worse than any figure: it is counted, is
//! never left out of a quantile, and misses every limit that it reaches.

pub mod case;
mod error;
pub mod journal;
pub mod law;
pub mod limits;
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

use case::{Case, CaseId};
pub use error::CampaignError;
use journal::JournalError;
use plan::Settings;
use report::Report;
use runs::{CaseResult, Ended};

/// A battery and the results it has so far.
#[derive(Debug)]
pub struct Campaign {
    settings: Settings,
    cases: Vec<Case>,
    /// In the order of the tables.
    results: BTreeMap<CaseId, CaseResult>,
}

impl Campaign {
    /// A battery without any results.
    ///
    /// # Errors
    /// A scenario does not take what the battery sets in it.
    pub fn new(settings: Settings) -> Result<Self, ScenarioErrors> {
        let cases = plan::cases(&settings)?;
        Ok(Self { settings, cases, results: BTreeMap::new() })
    }

    /// Number of runs in all.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cases.len()
    }

    /// Whether there is nothing to run.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }

    /// Number of results so far.
    #[must_use]
    pub fn done(&self) -> usize {
        self.results.len()
    }

    /// Takes a result of an earlier time.
    ///
    /// # Errors
    /// It is none of this battery's, or has been taken before.
    pub fn take(&mut self, result: CaseResult) -> Result<(), &'static str> {
        if !self.cases.iter().any(|case| case.id == result.case) {
            return Err("the result of a run that this battery does not have");
        }
        match self.results.insert(result.case, result) {
            None => Ok(()),
            Some(_) => Err("a second result of a run"),
        }
    }

    /// Makes the runs that have no result yet. `keep` sees each result first.
    ///
    /// # Errors
    /// A run could not be made, or a result not be kept.
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

    /// The runs that have a result, with it, in the order of the tables.
    pub fn results(&self) -> impl Iterator<Item = (&Case, &CaseResult)> {
        self.cases.iter().filter_map(|case| Some((case, self.results.get(&case.id)?)))
    }

    /// The tables. They are those of the whole battery once every run has a result.
    #[must_use]
    pub fn report(&self) -> Report {
        Report::new(&self.settings, self.results.values())
    }
}
