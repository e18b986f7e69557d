//! Counts of tests, read from the output of test programs. Every other step of a chore counts one.

use std::fmt;
use std::io::{self, BufRead, BufReader};
use std::ops::AddAssign;
use std::process::{Command, ExitCode};
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
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} passed, {} failed", self.passed, self.failed)?;
        if self.left_out > 0 { write!(out, ", {} left out", self.left_out) } else { Ok(()) }
    }
}

impl Counts {
    pub(crate) const PASSED: Self = Self { passed: 1, failed: 0, left_out: 0 };
    pub(crate) const FAILED: Self = Self { passed: 0, failed: 1, left_out: 0 };

    /// Adds the counts of a step. A step that fails doesn't keep later steps from running: one call reports every failure.
    pub(crate) fn step<C: Into<Self>>(&mut self, name: &str, run: impl FnOnce() -> Result<C>) {
        println!("== {name}");
        let (started, before) = (Instant::now(), cpu_time::of_children());
        *self += run().map_or_else(
            |error| {
                println!("{name} failed: {error:#}");
                Self::FAILED
            },
            Into::into,
        );
        if let Some((before, after)) = before.zip(cpu_time::of_children()) {
            println!("{name}: {:.0?}, {}", started.elapsed(), cpu_time::line(after - before));
        }
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
        print: impl Fn(&str),
    ) -> Result<Self> {
        let (name, cannot_start) = (command::name(&command), command::cannot_start(&command));
        let (reader, writer) = io::pipe()?;
        let mut child = command.stdout(writer.try_clone()?).stderr(writer).spawn().context(cannot_start)?;
        // The command holds the writing end, which would keep the pipe open.
        drop(command);
        let mut sum = Self::default();
        for line in BufReader::new(reader).split(b'\n') {
            // A test may print bytes that are no UTF-8.
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
        Self::of_line(r"^(\d+) passed, (\d+) failed(?:, (\d+) left out)?$", line)
    }

    /// `test result: ok. 3 passed; 0 failed; 0 ignored; ...`
    pub(crate) fn of_libtest(line: &str) -> Option<Self> {
        Self::of_line(r"^test result: \w+\. (\d+) passed; (\d+) failed; (\d+) ignored", line)
    }

    fn of_line(pattern: &str, line: &str) -> Option<Self> {
        let captures = Regex::new(pattern).ok()?.captures(line)?;
        let count = |group| captures.get(group).map_or(Some(0), |count| count.as_str().parse().ok());
        Some(Self { passed: count(1)?, failed: count(2)?, left_out: count(3)? })
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
    use std::sync::Mutex;

    use super::Counts;

    /// The counts of a shell script, with the lines that were printed.
    fn of_script(script: &str, read: fn(&str) -> Option<Counts>) -> (Counts, Vec<String>) {
        let mut shell = Command::new("sh");
        shell.args(["-c", script]);
        let lines = Mutex::new(Vec::new());
        let keep = |line: &str| lines.lock().expect("one thread").push(line.to_owned());
        let counts = Counts::of_output(shell, read, keep).expect("a shell");
        (counts, lines.into_inner().expect("one thread"))
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
        assert_eq!(counts, Counts { passed: 42, failed: 3, left_out: 1 });
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
        assert_eq!(counts, Counts { passed: 2, failed: 1, left_out: 0 });
    }

    #[test]
    fn a_skipped_test_of_pytest_counts_as_failed() {
        let line = "= 2 failed, 40 passed, 1 skipped, 3 warnings, 2 errors in 71.35s (0:01:11) =";
        assert_eq!(Counts::of_pytest(line), Some(Counts { passed: 40, failed: 5, left_out: 0 }));
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
    fn a_sum_is_read_as_it_is_written() {
        for (left_out, text) in [(0, "1200 passed, 3 failed"), (15, "1200 passed, 3 failed, 15 left out")] {
            let counts = Counts { passed: 1200, failed: 3, left_out };
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
