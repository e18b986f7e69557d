//! Results in the order of the plan, and the exit code of the suite.

use std::collections::HashMap;

use lashloop_bench::verdict::Exit;

use super::case_result::{CaseResult, Status};
use super::plan::{Case, Job};

/// The cases of a suite with their results so far.
#[derive(Debug)]
pub struct Tally {
    pub cases: Vec<Case>,
    /// Position of each case by its name.
    positions: HashMap<String, usize>,
    results: HashMap<String, CaseResult>,
}

impl Tally {
    /// A suite without results but for those of cases that need no run.
    #[must_use]
    pub fn new(cases: Vec<Case>) -> Self {
        let positions = cases.iter().zip(0..).map(|(case, position)| (case.name.clone(), position)).collect();
        let mut tally = Self { cases, positions, results: HashMap::new() };
        for case in &tally.cases {
            let result = match &case.job {
                Job::Run { .. } => continue,
                Job::Skip(reason) => {
                    CaseResult::without_run(&case.name, Status::Skipped, vec![reason.clone()])
                }
                Job::Report(errors) => {
                    CaseResult::without_run(&case.name, Status::BadScenario, errors.clone())
                }
            };
            tally.results.insert(case.name.clone(), result);
        }
        tally
    }

    /// Adds a result of the journal, if its case is unchanged.
    pub fn restore(&mut self, result: CaseResult) {
        let case = self.positions.get(&result.case).map(|position| &self.cases[*position].job);
        if matches!(case, Some(Job::Run { sha256, .. }) if Some(sha256) == result.scenario_sha256.as_ref()) {
            self.add(result);
        }
    }

    pub fn add(&mut self, result: CaseResult) {
        self.results.insert(result.case.clone(), result);
    }

    /// Cases without a result.
    #[must_use]
    pub fn missing(&self) -> Vec<Case> {
        self.cases.iter().filter(|case| !self.results.contains_key(&case.name)).cloned().collect()
    }

    /// Cases with their results, in the order of the plan.
    pub fn rows(&self) -> impl Iterator<Item = (&Case, &CaseResult)> {
        self.cases.iter().filter_map(|case| Some((case, self.results.get(&case.name)?)))
    }

    #[must_use]
    pub fn done(&self) -> usize {
        self.results.len()
    }

    /// Number of results with this word.
    #[must_use]
    pub fn count(&self, word: &str) -> usize {
        self.results.values().filter(|result| result.status.word() == word).count()
    }

    /// The largest exit code of a case; that of bad usage if no case has one, because a suite never passes for lack of runs.
    #[must_use]
    pub fn exit(&self) -> Exit {
        let judged = self.results.values().map(|result| result.status).filter(|it| *it != Status::Skipped);
        judged.map(Status::exit).max_by_key(|exit| *exit as u8).unwrap_or(Exit::UsageOrScenario)
    }
}
