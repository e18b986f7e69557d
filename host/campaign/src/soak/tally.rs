//! The totals of a soak.

use std::fmt;
use std::time::Duration;

use super::plan::SHARES;
use super::resource_usage::{self, Growth, Usage};
use super::{judge, plan};
use lashloop::execution::ExecutionError;
use lashloop_bench::run::{End, Outcome};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::Verdict;
use lashloop_session::counted;

/// The totals of one level.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Level {
    pub runs: u64,
    pub passed: u64,
    pub failed: u64,
    pub invalid: u64,
    pub steps: u64,
    /// Frames hit by link faults.
    pub hit: u64,
    /// Steps without an answer.
    pub lost: u64,
    /// Damaged frames, counted on either side.
    pub damaged: u64,
}

#[derive(Debug, Clone, Default)]
pub struct Tally {
    pub levels: [Level; SHARES.len()],
    /// Violations, each with its run.
    pub problems: Vec<String>,
    pub took: Duration,
    bench: Growth,
    drive: Growth,
    pub runs: u64,
    /// Whether it ended before its time.
    pub interrupted: bool,
    healthy_digest: Option<String>,
}

impl Tally {
    /// Adds a run and the resources of bench and drive.
    pub fn push(
        &mut self,
        scenario: &Scenario,
        result: &Result<Outcome, ExecutionError>,
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
        // The first cycle through the levels allocates; growth counts after it.
        if self.runs >= SHARES.len() as u64 {
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

    /// Runs without faults and losses are equal bit for bit.
    fn other_torques(&mut self, level: usize, outcome: &Outcome) -> Option<String> {
        if level > 0 || outcome.link.lost > 0 {
            return None;
        }
        let first = self.healthy_digest.get_or_insert_with(|| outcome.torque_sha256.clone());
        (*first != outcome.torque_sha256)
            .then(|| "other torques than in the first run without faults".to_owned())
    }
}

impl Tally {
    /// FAIL with any problem. Without one, a soak that was cut short proves nothing.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        match (self.problems.is_empty(), self.interrupted) {
            (false, _) => Verdict::Fail,
            (true, true) => Verdict::Invalid,
            (true, false) => Verdict::Pass,
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "level  rate     runs  PASS  FAIL  INVALID      steps   hit  damaged  lost")?;
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
            None => writeln!(out, "bench  too few runs to measure growth")?,
        }
        match self.drive.first {
            Some(_) => writeln!(out, "drive  {} in the run in which it grew most", growth(&self.drive))?,
            None => writeln!(out, "drive  not a process of the bench")?,
        }
        for problem in &self.problems {
            writeln!(out, "WRONG  {problem}")?;
        }
        let how = if self.interrupted { "interrupted after" } else { "in" };
        write!(
            out,
            "{}, {how} {:.1} s\n{}",
            counted(self.runs, "run"),
            self.took.as_secs_f64(),
            self.verdict()
        )
    }
}
