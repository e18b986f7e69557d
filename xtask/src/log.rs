//! The whole output of the chores of `cargo xtask test`, as `target/chores/CHORE.log`, and which of its lines are worth printing.

use std::fs::{self, File};
use std::io::Write;
use std::mem;
use std::path::PathBuf;
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Duration;

use anyhow::{Context, Result};
use regex_lite::Regex;

use crate::{cpu_time, paths};

/// Status of cargo, a test that passed, progress of pytest and of a fuzzer.
static PROGRESS: LazyLock<Regex> = LazyLock::new(|| {
    let cargo = "[ ]+[A-Z][a-z]+ (?:v?[0-9]|[a-z`(]|dev|DIR).*";
    let libtest = r"running \d+ tests?|test .* \.\.\. ok(?:, [0-9.]+ s)?|test result: ok\..*";
    let pytest = r".*\[ *\d+%\]|=+ slowest .*|\(\d+ durations .*|[0-9.]+s (?:call|setup|teardown) .*|=+ test session starts =+|(?:platform|rootdir|configfile|plugins|testpaths): ?.*";
    Regex::new(&format!("^(?:|{cargo}|{libtest}|{pytest}|#\\d+\t.*)$")).expect("a constant pattern")
});

/// The name of a test or a step that failed, also of one that passed at its second attempt, was slow or gave no verdict.
static FAILURE: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r"^(?:test .* \.\.\. (?:FAILED|not judged).*|test .* half of its limit|(?:FAILED|ERROR) \S+::.*|error(?:\[E\d+\])?: .*|.{1,60} failed: .*|.* ended with .*|second attempt of .*)$")
        .expect("a constant pattern")
});

/// At most this many failures of a chore are repeated at the end.
const FAILURES: usize = 20;

/// The folder of the logs.
pub(crate) fn folder() -> PathBuf {
    paths::root().join("target/chores")
}

pub(crate) fn is_progress(line: &str) -> bool {
    PROGRESS.is_match(line) || cpu_time::is_time(line)
}

/// The output of one chore.
pub(crate) struct Log {
    file: Mutex<File>,
    failures: Mutex<Vec<String>>,
    cpu_time: Mutex<Option<String>>,
    durations: Mutex<Vec<(f64, String)>>,
}

impl Log {
    /// # Errors
    /// The file can't be created.
    pub(crate) fn create(chore: &str) -> Result<Self> {
        let path = folder().join(format!("{}.log", chore.replace(' ', "-")));
        fs::create_dir_all(folder())?;
        let file = File::create(&path).with_context(|| format!("{} can't be created", path.display()))?;
        Ok(Self {
            file: Mutex::new(file),
            failures: Mutex::default(),
            cpu_time: Mutex::default(),
            durations: Mutex::default(),
        })
    }

    /// Appends a line. A disk that is full must not end the tests.
    pub(crate) fn write(&self, line: &str) {
        let _ = writeln!(self.file.lock().unwrap_or_else(PoisonError::into_inner), "{line}");
        if FAILURE.is_match(line) {
            self.failures.lock().unwrap_or_else(PoisonError::into_inner).push(line.to_owned());
        }
        if let Some((seconds, name)) = duration(line) {
            let mut durations = self.durations.lock().unwrap_or_else(PoisonError::into_inner);
            durations.push((seconds, name.to_owned()));
        }
        if let Some(time) = cpu_time::read(line) {
            *self.cpu_time.lock().unwrap_or_else(PoisonError::into_inner) = Some(time.to_owned());
        }
    }

    /// Time in seconds and name of each test.
    pub(crate) fn durations(&self) -> Vec<(f64, String)> {
        mem::take(&mut self.durations.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The processor time that the chore reported at its end.
    pub(crate) fn cpu_time(&self) -> Option<String> {
        self.cpu_time.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The lines that name a failure, the first of them.
    pub(crate) fn failures(&self) -> Vec<String> {
        let failures = self.failures.lock().unwrap_or_else(PoisonError::into_inner);
        failures.iter().take(FAILURES).cloned().collect()
    }
}

/// The end of a test's line.
pub(crate) fn taken(time: Duration) -> String {
    format!("{:.2} s", time.as_secs_f64())
}

/// Time in seconds and name in the line of a test, also in pytest's list of durations.
pub(crate) fn duration(line: &str) -> Option<(f64, &str)> {
    static TEST: LazyLock<Regex> =
        LazyLock::new(|| Regex::new(r"^test (.+) \.\.\. .*, ([0-9.]+) s$").expect("a constant pattern"));
    static PYTEST: LazyLock<Regex> = LazyLock::new(|| {
        Regex::new(r"^([0-9.]+)s (?:call|setup|teardown) +(\S.*)$").expect("a constant pattern")
    });
    if let Some(found) = TEST.captures(line) {
        let (_, [name, seconds]) = found.extract();
        return Some((seconds.parse().ok()?, name));
    }
    let (_, [seconds, name]) = PYTEST.captures(line)?.extract();
    Some((seconds.parse().ok()?, name))
}

#[cfg(test)]
mod tests {
    use super::{FAILURE, is_progress};

    #[test]
    fn what_passed_is_progress_and_what_failed_is_not() {
        for line in [
            "",
            "   Compiling serde v1.0.228",
            "    Finished `dev` profile [optimized] target(s) in 1m 12s",
            "running 17 tests",
            "test tests looped: soak::a_minute ... ok, 61.20 s",
            "test a ... ok",
            "2.31s call     tests/test_link.py::test_pause",
            "test result: ok. 17 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 8.37s",
            "tests/test_host_runs.py .............                                    [ 61%]",
        ] {
            assert!(is_progress(line), "{line}");
        }
        for line in [
            "== tests looped",
            "test soak::a_minute ... FAILED, 1.00 s",
            "test soak::a_minute has taken 90 s, half of its limit",
            "thread 'soak::a_minute' panicked at tests/looped/soak.rs:12:5:",
            "assertion `left == right` failed",
            "  left: 3",
            "test result: FAILED. 16 passed; 1 failed; 0 ignored",
            "error[E0308]: mismatched types",
            "FAILED tests/test_link.py::test_pause - AssertionError",
            "12 passed, 1 failed",
        ] {
            assert!(!is_progress(line), "{line}");
        }
    }

    #[test]
    fn a_failure_is_known_by_its_line() {
        for line in [
            "test soak::a_minute ... FAILED, 1.00 s",
            "test soak::a_minute ... not judged: 30 ms late, 1.00 s",
            "test soak::a_minute has taken 90 s, half of its limit",
            "error[E0308]: mismatched types",
            "FAILED tests/test_link.py::test_pause - AssertionError",
            "image size failed: the image is too large",
            "looped ended with signal: 9 (SIGKILL)",
            "second attempt of soak::a_minute: passed",
        ] {
            assert!(FAILURE.is_match(line), "{line}");
        }
        for line in ["test soak::a_minute ... ok", "12 passed, 0 failed", "570 passed, 0 failed"] {
            assert!(!FAILURE.is_match(line), "{line}");
        }
    }
}
