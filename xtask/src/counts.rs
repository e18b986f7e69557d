//! Counts of tests, read from the output of test programs. Every other step of a chore counts one.

use std::fmt;
use std::io::{self, BufRead, BufReader};
use std::ops::AddAssign;
use std::process::{Command, ExitCode};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result};
use regex_lite::Regex;

use crate::{command, cpu_time};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    /// Tests that this machine can't run, each named where it is left out.
    pub(crate) left_out: u64,
    /// Tests of wall-clock time that a busy machine spoiled twice, each named with what it saw.
    pub(crate) not_judged: u64,
}

/// A step that succeeds.
impl From<()> for Counts {
    fn from((): ()) -> Self {
        Self::PASSED
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.left_out += other.left_out;
        self.not_judged += other.not_judged;
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} passed, {} failed", self.passed, self.failed)?;
        for (count, what) in [(self.left_out, "left out"), (self.not_judged, "not judged")] {
            if count > 0 {
                write!(out, ", {count} {what}")?;
            }
        }
        Ok(())
    }
}

impl Counts {
    const NONE: Self = Self { passed: 0, failed: 0, left_out: 0, not_judged: 0 };
    pub(crate) const PASSED: Self = Self { passed: 1, ..Self::NONE };
    pub(crate) const FAILED: Self = Self { failed: 1, ..Self::NONE };
    pub(crate) const NOT_JUDGED: Self = Self { not_judged: 1, ..Self::NONE };

    /// Adds the counts of a step. A step that fails doesn't keep later steps from running: one call reports every failure.
    pub(crate) fn step<C: Into<Self>>(&mut self, name: &str, run: impl FnOnce() -> Result<C>) {
        println!("== {name}");
        let (started, before) = (Instant::now(), cpu_time::of_children());
        *self += run().map_or_else(|error| Self::failed(name, &error), Into::into);
        if let Some((before, after)) = before.zip(cpu_time::of_children()) {
            println!("{name}: {:.0?}, {}", started.elapsed(), cpu_time::line(after - before));
        }
    }

    /// Prints why a step failed.
    pub(crate) fn failed(name: &str, error: &anyhow::Error) -> Self {
        println!("{name} failed: {error:#}");
        Self::FAILED
    }

    /// Adds up the counts of `run` for each item, which also gets the number of its worker. Items start in their order, `at_once`
    /// at a time.
    pub(crate) fn of_each<'a, T: Sync>(
        items: &'a [T],
        at_once: usize,
        run: impl Fn(&'a T, usize) -> Self + Sync,
    ) -> Self {
        let items = Mutex::new(items.iter());
        let work = |worker| {
            let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
            let mut sum = Self::default();
            while let Some(item) = next() {
                sum += run(item, worker);
            }
            sum
        };
        thread::scope(|scope| {
            let workers: Vec<_> = (0..at_once).map(|worker| scope.spawn(move || work(worker))).collect();
            let mut sum = Self::default();
            for worker in workers {
                sum += worker.join().unwrap_or(Self::FAILED);
            }
            sum
        })
    }

    /// Prints the sum alone on the last line.
    pub(crate) fn print(self) -> ExitCode {
        if let Some(time) = cpu_time::of_children() {
            println!("all: {}", cpu_time::line(time));
        }
        println!("{self}");
        if self.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }

    /// Runs `command`, passes each line of its output to `print`, and sums up the counts that `read` finds in it.
    pub(crate) fn of_output(
        mut command: Command,
        read: impl Fn(&str) -> Option<Self>,
        mut print: impl FnMut(&str),
    ) -> Result<Self> {
        let (name, cannot_start) = (command::name(&command), command::cannot_start(&command));
        let (reader, writer) = io::pipe()?;
        let mut child = command.stdout(writer.try_clone()?).stderr(writer).spawn().context(cannot_start)?;
        // The command holds the writing end, which would keep the pipe open.
        drop(command);
        let mut sum = Self::default();
        for line in BufReader::new(reader).split(b'\n') {
            // A test may print bytes that aren't UTF-8.
            let line = String::from_utf8_lossy(&line?).into_owned();
            print(&line);
            sum += read(&line).unwrap_or_default();
        }
        let status = child.wait()?;
        // A program that a signal ends prints no result.
        if !status.success() && sum.failed == 0 {
            println!("{name} ended with {status}");
            sum.failed = 1;
        }
        Ok(sum)
    }

    /// The line that a chore ends with, as [`fmt::Display`] writes it.
    pub(crate) fn of_sum(line: &str) -> Option<Self> {
        Self::of_line(r"^(\d+) passed, (\d+) failed(?:, (\d+) left out)?(?:, (\d+) not judged)?$", line)
    }

    /// `test result: ok. 3 passed; 0 failed; 0 ignored; ...`
    pub(crate) fn of_libtest(line: &str) -> Option<Self> {
        Self::of_line(r"^test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored", line)
    }

    fn of_line(pattern: &str, line: &str) -> Option<Self> {
        let captures = Regex::new(pattern).ok()?.captures(line)?;
        let count = |group| captures.get(group).map_or(Some(0), |count| count.as_str().parse().ok());
        Some(Self { passed: count(1)?, failed: count(2)?, left_out: count(3)?, not_judged: count(4)? })
    }

    /// `===== 2 failed, 40 passed, 1 error in 1.35s =====`
    pub(crate) fn of_pytest(line: &str) -> Option<Self> {
        let result = Regex::new(r"^=* ?((?:\d+ [a-z]+(?:, )?)+) in [\d.]+s(?: \([\d:]+\))? ?=*$").ok()?;
        let (_, [results]) = result.captures(line)?.extract();
        let mut sum = Self::default();
        for result in results.split(", ") {
            let (count, what) = result.split_once(' ')?;
            let count: u64 = count.parse().ok()?;
            match what {
                "passed" => sum.passed += count,
                // A skipped test has not passed.
                "failed" | "error" | "errors" | "skipped" | "xfailed" | "xpassed" => sum.failed += count,
                "warning" | "warnings" | "deselected" => {}
                _ => return None,
            }
        }
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use std::process::Command;
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::Counts;

    /// The counts of a shell script, with the lines that were printed.
    fn of_script(script: &str, read: fn(&str) -> Option<Counts>) -> (Counts, Vec<String>) {
        let mut shell = Command::new("sh");
        shell.args(["-c", script]);
        let mut lines = Vec::new();
        let counts = Counts::of_output(shell, read, |line| lines.push(line.to_owned())).expect("a shell");
        (counts, lines)
    }

    #[test]
    fn results_are_summed_and_every_line_is_printed() {
        let (counts, lines) = of_script(
            r"printf 'running 2 tests\ntest a ... ok\n\377\n'
            echo 'test result: ok. 2 passed; 0 failed; 1 ignored; 0 measured'
            echo 'test result: FAILED. 40 passed; 3 failed; 0 ignored; finished in 0.00s' >&2
            printf end; exit 101",
            Counts::of_libtest,
        );
        assert_eq!(counts, Counts { passed: 42, failed: 3, left_out: 1, not_judged: 0 });
        assert_eq!(lines.len(), 6);
        assert_eq!(lines[2], "\u{fffd}");
        assert_eq!(lines[5], "end");
    }

    #[test]
    fn a_program_that_a_signal_ends_counts_as_failed() {
        let (counts, _) = of_script(
            "echo 'test result: ok. 2 passed; 0 failed; 0 ignored'; kill -9 $$",
            Counts::of_libtest,
        );
        assert_eq!(counts, Counts { passed: 2, failed: 1, ..Counts::default() });
    }

    #[test]
    fn a_skipped_test_of_pytest_counts_as_failed() {
        let line = "= 2 failed, 40 passed, 1 skipped, 3 warnings, 2 errors in 71.35s (0:01:11) =";
        assert_eq!(Counts::of_pytest(line), Some(Counts { passed: 40, failed: 5, ..Counts::default() }));
        assert_eq!(Counts::of_pytest("1 passed in 0.01s"), Some(Counts::PASSED));
        for line in [
            "12 passed in 3.4s, prints a test",
            "collected 7 items in 1s",
            "no tests ran in 0.01s",
            "3 passed in hope",
        ] {
            assert_eq!(Counts::of_pytest(line), None, "{line}");
        }
    }

    #[test]
    fn as_many_items_run_at_once_as_asked_and_each_once() {
        // With one worker it would never end.
        let (both, runs) = (Barrier::new(2), AtomicUsize::new(0));
        let counts = Counts::of_each(&[1, 2, 3, 4], 2, |number, _| {
            both.wait();
            runs.fetch_add(1, Ordering::Relaxed);
            Counts { passed: *number, ..Counts::default() }
        });
        assert_eq!((counts.passed, runs.into_inner()), (10, 4));
        let panicking = Counts::of_each(&[()], 2, |(), _| panic!("a worker that panics"));
        assert_eq!(panicking, Counts::FAILED);
    }

    #[test]
    fn a_sum_is_read_as_it_is_written() {
        for (left_out, not_judged, text) in [
            (0, 0, "1200 passed, 3 failed"),
            (15, 0, "1200 passed, 3 failed, 15 left out"),
            (0, 2, "1200 passed, 3 failed, 2 not judged"),
            (15, 2, "1200 passed, 3 failed, 15 left out, 2 not judged"),
        ] {
            let counts = Counts { passed: 1200, failed: 3, left_out, not_judged };
            assert_eq!(counts.to_string(), text);
            assert_eq!(Counts::of_sum(text), Some(counts));
        }
        for line in ["12 passed, no failed", "all: 1 passed, 0 failed", "1 passed, 0 failed."] {
            assert_eq!(Counts::of_sum(line), None, "{line}");
        }
    }

    #[test]
    fn lines_that_only_look_like_results_count_nothing() {
        for line in [
            "test result: ok.",
            "test result: ok. many passed; 0 failed;",
            "the test result: ok. 2 passed; 0 failed;",
        ] {
            assert_eq!(Counts::of_libtest(line), None, "{line}");
        }
    }
}
