//! Results in the order of the plan, and what they say of the suite.

use std::collections::HashMap;

use lashloop_bench::verdict::Exit;
use lashloop_session::counted;

use super::case_result::{CaseResult, Status};
use super::plan::{Case, Job};

/// The cases of a suite with their results so far.
#[derive(Debug)]
pub struct Tally<'a> {
    pub cases: &'a [Case],
    /// Position of each case by its name.
    positions: HashMap<&'a str, usize>,
    /// Result of each case, its metrics against their baseline.
    results: Vec<Option<CaseResult>>,
}

/// What the results say of the suite as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conclusion {
    /// Every case has a result, and this is the worst of those that were judged.
    Judged(Status),
    /// Every case was skipped.
    NothingRun,
    /// Cases lack a result.
    Incomplete,
}

impl Conclusion {
    /// The word on a page.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Judged(worst) => worst.word(),
            Self::NothingRun => "NO VERDICT",
            Self::Incomplete => "INCOMPLETE",
        }
    }

    /// The exit code: a suite never passes for lack of runs.
    #[must_use]
    pub const fn exit(self) -> Exit {
        match self {
            Self::Judged(worst) => worst.exit(),
            Self::NothingRun => Exit::UsageOrScenario,
            Self::Incomplete => Exit::Invalid,
        }
    }
}

impl<'a> Tally<'a> {
    /// A suite without results but for those of cases that need no run.
    #[must_use]
    pub fn new(cases: &'a [Case]) -> Self {
        let positions = cases.iter().zip(0..).map(|(case, position)| (&*case.name, position)).collect();
        let result = |case: &Case| match &case.job {
            Job::Run { .. } => None,
            Job::Skip(reason) => {
                Some(CaseResult::without_run(&case.name, Status::Skipped, vec![reason.clone()]))
            }
            Job::Report(errors) => {
                Some(CaseResult::without_run(&case.name, Status::BadScenario, errors.clone()))
            }
        };
        Self { cases, positions, results: cases.iter().map(result).collect() }
    }

    /// Adds a result of the journal, if its case is unchanged and it is a verdict. A failure of device, link or set-up says
    /// nothing about the case, which runs again.
    pub fn restore(&mut self, result: CaseResult) {
        let case = self.positions.get(&*result.case).map(|position| &self.cases[*position].job);
        let is_same =
            matches!(case, Some(Job::Run { sha256, .. }) if Some(sha256) == result.scenario_sha256.as_ref());
        if is_same && result.status.is_verdict() {
            self.add(result);
        }
    }

    /// Adds the result of a run; returns it with its metrics against their baseline.
    pub fn add(&mut self, result: CaseResult) -> Option<&CaseResult> {
        let position = *self.positions.get(&*result.case)?;
        Some(self.results[position].insert(self.cases[position].judged(result)))
    }

    /// Cases without a result.
    #[must_use]
    pub fn missing(&self) -> Vec<&'a Case> {
        self.all().filter(|(_, result)| result.is_none()).map(|(case, _)| case).collect()
    }

    /// Every case, in the order of the plan.
    pub fn all(&self) -> impl Iterator<Item = (&'a Case, Option<&CaseResult>)> {
        self.cases.iter().zip(self.results.iter().map(Option::as_ref))
    }

    /// Cases with their results, in the order of the plan.
    pub fn rows(&self) -> impl Iterator<Item = (&'a Case, &CaseResult)> {
        self.all().filter_map(|(case, result)| Some((case, result?)))
    }

    #[must_use]
    pub fn done(&self) -> usize {
        self.rows().count()
    }

    /// Number of results with this word.
    #[must_use]
    pub fn count(&self, word: &str) -> usize {
        self.rows().filter(|(_, result)| result.status.word() == word).count()
    }

    /// Why the suite has no verdict, in one sentence; `None` with a verdict.
    #[must_use]
    pub fn shortfall(&self) -> Option<String> {
        let all = self.cases.len();
        match self.conclusion() {
            Conclusion::Judged(_) => None,
            Conclusion::NothingRun => Some(format!("no case was run; {all} of {all} are skipped")),
            Conclusion::Incomplete => {
                Some(format!("interrupted; {} of {} have a result", self.done(), counted(all as u64, "case")))
            }
        }
    }

    #[must_use]
    pub fn conclusion(&self) -> Conclusion {
        if self.results.iter().any(Option::is_none) {
            return Conclusion::Incomplete;
        }
        let judged = self.rows().map(|(_, result)| result.status).filter(|it| *it != Status::Skipped);
        judged.max_by_key(|status| status.exit() as u8).map_or(Conclusion::NothingRun, Conclusion::Judged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The conclusion of cases with these statuses; `None` has no result.
    fn conclusion(statuses: &[Option<Status>]) -> Conclusion {
        let case = |name: String| {
            let job = Job::Skip(String::new());
            Case { file: name.clone().into(), name, settings: Vec::new(), baseline: None, job }
        };
        let cases: Vec<_> = (0..statuses.len()).map(|number| case(number.to_string())).collect();
        let mut tally = Tally::new(&cases);
        let result = |(case, status): (&Case, &Option<Status>)| {
            status.map(|status| CaseResult::without_run(&case.name, status, Vec::new()))
        };
        tally.results = cases.iter().zip(statuses).map(result).collect();
        assert_eq!(tally.missing().len() + tally.done(), cases.len());
        tally.conclusion()
    }

    #[test]
    fn a_suite_concludes_by_its_worst_case_if_every_case_has_a_result() {
        use Status::{BadScenario, DeviceOrLink, Fail, Invalid, Pass, Skipped};
        for (statuses, want, exit) in [
            (&[Some(Skipped), Some(Pass)][..], Conclusion::Judged(Pass), Exit::Pass),
            (&[Some(Fail), Some(Pass)], Conclusion::Judged(Fail), Exit::Fail),
            (&[Some(BadScenario), Some(Fail)], Conclusion::Judged(BadScenario), Exit::UsageOrScenario),
            (&[Some(Invalid), Some(BadScenario)], Conclusion::Judged(Invalid), Exit::Invalid),
            (&[Some(Invalid), Some(DeviceOrLink)], Conclusion::Judged(DeviceOrLink), Exit::DeviceOrLink),
            (&[Some(Skipped), Some(Skipped)], Conclusion::NothingRun, Exit::UsageOrScenario),
            (&[], Conclusion::NothingRun, Exit::UsageOrScenario),
            (&[Some(Pass), None], Conclusion::Incomplete, Exit::Invalid),
            (&[Some(DeviceOrLink), None], Conclusion::Incomplete, Exit::Invalid),
        ] {
            let conclusion = conclusion(statuses);
            assert_eq!((conclusion, conclusion.exit()), (want, exit), "{statuses:?}");
        }
    }
}
