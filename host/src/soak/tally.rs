//! What came of all runs.

use std::fmt;
use std::time::Duration;

use super::plan::SHARES;
use super::resource_usage::{self, Growth, Usage};
use super::{judge, plan};
use lashloop_bench::run::{End, Outcome, RunError};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::Verdict;

/// What came of the runs of one level.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Level {
    /// Runs begun.
    pub runs: u64,
    /// Of those PASS.
    pub passed: u64,
    /// FAIL.
    pub failed: u64,
    /// INVALID.
    pub invalid: u64,
    /// Steps made.
    pub steps: u64,
    /// Frames hit by faults of the line.
    pub hit: u64,
    /// Steps without an answer.
    pub lost: u64,
    /// Frames that arrived damaged, on either side.
    pub damaged: u64,
}

/// What came of all runs so far.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Level by level.
    pub levels: [Level; SHARES.len()],
    /// What should not be, each with its run.
    pub problems: Vec<String>,
    /// Time so far.
    pub took: Duration,
    bench: Growth,
    drive: Growth,
    runs: u64,
    interrupted: bool,
    healthy_digest: Option<String>,
}

impl Tally {
    /// Takes the next run and what the two processes held.
    pub fn push(
        &mut self,
        scenario: &Scenario,
        result: &Result<Outcome, RunError>,
        bench: Usage,
        drive: &Growth,
    ) {
        let run = self.runs;
        self.runs += 1;
        let mut problems = Vec::new();
        match result {
            Ok(outcome) if outcome.end == End::Interrupted => self.interrupted = true,
            Ok(outcome) => {
                self.count(plan::level(run), outcome);
                problems.extend(judge::wrong(scenario, outcome));
                problems.extend(self.other_torques(plan::level(run), outcome));
            }
            Err(error) => {
                self.levels[plan::level(run)].runs += 1;
                problems.push(error.to_string());
            }
        }
        if drive.so_far().rss_kib >= self.drive.so_far().rss_kib {
            self.drive = *drive;
        }
        problems
            .extend(drive.beyond(resource_usage::DRIVE).map(|grown| format!("the drive's process: {grown}")));
        if self.judges_growth() {
            let was_fine = self.bench.beyond(resource_usage::BENCH).is_none();
            self.bench.push(bench);
            problems.extend(
                self.bench
                    .beyond(resource_usage::BENCH)
                    .filter(|_| was_fine)
                    .map(|grown| format!("the bench: {grown}")),
            );
        }
        self.problems.extend(problems.into_iter().map(|problem| format!("run {run}: {problem}")));
    }

    /// A process that has not done everything once has not taken all the memory it needs.
    fn judges_growth(&self) -> bool {
        self.runs >= SHARES.len() as u64
    }

    fn count(&mut self, level: usize, outcome: &Outcome) {
        let level = &mut self.levels[level];
        level.runs += 1;
        match outcome.judgement.verdict {
            Verdict::Pass => level.passed += 1,
            Verdict::Fail => level.failed += 1,
            Verdict::Invalid => level.invalid += 1,
        }
        level.steps += outcome.steps;
        level.hit += outcome.faults.iter().filter_map(|fault| fault.frames).sum::<u64>();
        level.lost += outcome.link.lost;
        level.damaged += outcome.link.crc_errors + outcome.link.damaged_at_drive;
    }

    /// Runs without a fault and without a loss are the same run, bit by bit.
    fn other_torques(&mut self, level: usize, outcome: &Outcome) -> Option<String> {
        if level > 0 || outcome.link.lost > 0 {
            return None;
        }
        let first = self.healthy_digest.get_or_insert_with(|| outcome.torque_sha256.clone());
        (*first != outcome.torque_sha256)
            .then(|| "other torques than in the first run without faults".to_owned())
    }

    /// Runs so far.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Whether the user ended it.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.interrupted
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "level  share    runs  PASS  FAIL  INVALID      steps   hit  damaged  lost")?;
        for (number, (level, share)) in self.levels.iter().zip(SHARES).enumerate() {
            let Level { runs, passed, failed, invalid, steps, hit, lost, damaged } = level;
            writeln!(
                out,
                "{number:>5}  {share:<6} {runs:>6} {passed:>5} {failed:>5} {invalid:>8} {steps:>10} {hit:>5} {damaged:>8} {lost:>5}"
            )?;
        }
        writeln!(out)?;
        let growth = |growth: &Growth| {
            let Usage { rss_kib, descriptors } = growth.so_far();
            format!("grew by {rss_kib} KiB to {} KiB, and by {descriptors} descriptors", growth.most.rss_kib)
        };
        match self.bench.first {
            Some(_) => writeln!(out, "bench  {}", growth(&self.bench))?,
            None => writeln!(out, "bench  too few runs to see it grow")?,
        }
        match self.drive.first {
            Some(_) => writeln!(out, "drive  {} in the run in which it grew most", growth(&self.drive))?,
            None => writeln!(out, "drive  no process of the bench")?,
        }
        for problem in &self.problems {
            writeln!(out, "WRONG  {problem}")?;
        }
        let how = if self.interrupted { "interrupted after" } else { "in" };
        let verdict = if self.problems.is_empty() { "PASS" } else { "FAIL" };
        write!(out, "{} runs, {how} {:.1} s\n{verdict}", self.runs, self.took.as_secs_f64())
    }
}
