//! Counting tests by what libtest prints.

use std::io::{self, BufRead, Write};
use std::ops::AddAssign;

/// How many tests passed and failed.
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

impl Counts {
    /// Copies `from` to `to` line by line and adds up the results in it.
    pub(crate) fn of_stream(mut from: impl BufRead, mut to: impl Write) -> io::Result<Self> {
        let mut sum = Self::default();
        let mut line = Vec::new();
        while from.read_until(b'\n', &mut line)? > 0 {
            to.write_all(&line)?;
            to.flush()?;
            // What a test prints need not be text.
            if let Some(counts) = Self::of_line(&String::from_utf8_lossy(&line)) {
                sum += counts;
            }
            line.clear();
        }
        Ok(sum)
    }

    /// `test result: ok. 3 passed; 0 failed; ...`
    fn of_line(line: &str) -> Option<Self> {
        let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
        let mut parts = counts.split("; ");
        let mut next = |what: &str| parts.next()?.strip_suffix(what)?.trim().parse().ok();
        Some(Self { passed: next("passed")?, failed: next("failed")? })
    }
}

#[cfg(test)]
mod tests {
    use super::Counts;

    #[test]
    fn results_are_added_up_and_the_stream_passes_through_unchanged() {
        let stream = b"running 2 tests\ntest a ... ok\n\xff\ntest result: ok. 2 passed; 0 failed; 1 ignored; 0 measured\n\
            test result: FAILED. 40 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\nend";
        let mut copy = Vec::new();
        let counts = Counts::of_stream(&stream[..], &mut copy).expect("memory can be read and written");
        assert_eq!(counts, Counts { passed: 42, failed: 3 });
        assert_eq!(copy, stream);
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
