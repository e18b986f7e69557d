//! Counts of tests, read from the output of libtest and pytest.

use std::fmt;
use std::io::{self, BufRead, Write};
use std::ops::AddAssign;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} passed, {} failed", self.passed, self.failed)
    }
}

impl Counts {
    /// The line that a chore ends with, as [`fmt::Display`] writes it.
    pub(crate) fn of_sum(line: &str) -> Option<Self> {
        let (passed, failed) = line.strip_suffix(" failed")?.split_once(" passed, ")?;
        Some(Self { passed: passed.parse().ok()?, failed: failed.parse().ok()? })
    }

    /// Copies `from` to `to` line by line and adds up the results of libtest in it.
    pub(crate) fn of_stream(from: impl BufRead, to: impl Write) -> io::Result<Self> {
        let mut sum = Self::default();
        copy_lines(from, to, |line| sum += Self::of_line(line).unwrap_or_default())?;
        Ok(sum)
    }

    /// Copies `from` to `to` line by line and returns the result in pytest's last line.
    pub(crate) fn of_pytest(from: impl BufRead, to: impl Write) -> io::Result<Self> {
        let mut last = Self::default();
        copy_lines(from, to, |line| last = Self::of_pytest_line(line).unwrap_or(last))?;
        Ok(last)
    }

    /// `test result: ok. 3 passed; 0 failed; ...`
    fn of_line(line: &str) -> Option<Self> {
        let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
        let mut parts = counts.split("; ");
        let mut next = |what: &str| parts.next()?.strip_suffix(what)?.trim().parse().ok();
        Some(Self { passed: next("passed")?, failed: next("failed")? })
    }

    /// `===== 2 failed, 40 passed, 1 error in 1.35s =====`
    fn of_pytest_line(line: &str) -> Option<Self> {
        let (results, time) = line.trim_matches(['=', ' ', '\n']).rsplit_once(" in ")?;
        time.split(' ').next()?.strip_suffix('s')?.parse::<f64>().ok()?;
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

/// Passes each line to `look` as well.
fn copy_lines(mut from: impl BufRead, mut to: impl Write, mut look: impl FnMut(&str)) -> io::Result<()> {
    let mut line = Vec::new();
    while from.read_until(b'\n', &mut line)? > 0 {
        to.write_all(&line)?;
        to.flush()?;
        // A test may print bytes that are no UTF-8.
        look(&String::from_utf8_lossy(&line));
        line.clear();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io;

    use super::Counts;

    #[test]
    fn results_are_summed_and_the_stream_is_unchanged() {
        let stream = b"running 2 tests\ntest a ... ok\n\xff\ntest result: ok. 2 passed; 0 failed; 1 ignored; 0 measured\n\
            test result: FAILED. 40 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\nend";
        let mut copy = Vec::new();
        let counts = Counts::of_stream(&stream[..], &mut copy).expect("memory can be read and written");
        assert_eq!(counts, Counts { passed: 42, failed: 3 });
        assert_eq!(copy, stream);
    }

    #[test]
    fn a_skipped_test_of_pytest_counts_as_failed() {
        let stream = b"12 passed in 3.4s, prints a test\n\
            = 2 failed, 40 passed, 1 skipped, 3 warnings, 2 errors in 71.35s (0:01:11) =\n";
        let mut copy = Vec::new();
        let counts = Counts::of_pytest(&stream[..], &mut copy).expect("memory can be read and written");
        assert_eq!(counts, Counts { passed: 40, failed: 5 });
        assert_eq!(copy, stream);
        let quiet = Counts::of_pytest(&b"1 passed in 0.01s\n"[..], io::sink()).expect("memory can be read");
        assert_eq!(quiet, Counts { passed: 1, failed: 0 });
        for line in ["collected 7 items in 1s", "no tests ran in 0.01s", "3 passed in hope"] {
            assert_eq!(Counts::of_pytest_line(line), None, "{line}");
        }
    }

    #[test]
    fn a_sum_is_read_as_it_is_written() {
        let counts = Counts { passed: 1200, failed: 3 };
        assert_eq!(counts.to_string(), "1200 passed, 3 failed");
        assert_eq!(Counts::of_sum(&counts.to_string()), Some(counts));
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
            assert_eq!(Counts::of_line(line), None, "{line}");
        }
    }
}
