//! One test in a process of its own: it can neither fail, nor delay, nor outlive another one.

use std::fmt;
use std::fs::{self, File};
use std::io::{Read, Seek};
use std::num::NonZeroUsize;
use std::process::Child;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use rustix::process::{Pid, PidfdFlags, Signal, kill_process, pidfd_open};

use crate::command::{cannot_start, command};
use crate::counts::Counts;
use crate::log::taken;
use crate::test_programs::TestProgram;

/// Most failed tests of a ring that get a second attempt: more aren't a stall.
const SECOND_ATTEMPTS: usize = 3;

/// What the line begins with by which a test of wall-clock time gives no verdict.
const NOT_JUDGED: &str = "not judged: ";

/// A test of a program.
pub(crate) struct Test<'a> {
    pub(crate) program: &'a TestProgram,
    pub(crate) name: String,
}

/// How the tests of a ring run.
#[derive(Clone, Copy)]
pub(crate) struct Conditions {
    /// Tests that run at the same time.
    pub(crate) at_once: usize,
    /// Time for each test on a machine with a core for each program. One that takes longer is killed with the processes it has
    /// started, and has failed.
    pub(crate) limit: Duration,
    /// Whether a test that fails runs once more: on a machine that others use, a stall of some 100 ms fails a test of other
    /// processes. What fails twice has failed; what passes then is reported by name.
    pub(crate) has_second_attempt: bool,
}

/// Runs each test, and counts them.
pub(crate) fn run_each(tests: &[Test<'_>], conditions: Conditions) -> Counts {
    let failed = Mutex::new(Vec::new());
    let mut counts = Counts::of_each(tests, conditions.at_once, |test, worker| {
        let counts = test.run(worker, conditions.limit);
        if counts.failed > 0 {
            failed.lock().unwrap_or_else(PoisonError::into_inner).push(test);
        }
        counts
    });
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    if conditions.has_second_attempt && failed.len() <= SECOND_ATTEMPTS {
        for test in failed {
            let again = test.run(0, conditions.limit);
            let verdict = if again.failed == 0 { "passed" } else { "not passed" };
            println!("second attempt of {test}: {verdict}");
            if again.failed == 0 {
                counts.failed -= 1;
                counts += again;
            }
        }
    }
    counts
}

impl fmt::Display for Test<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}: {}", self.program.name, self.name)
    }
}

impl Test<'_> {
    /// Runs the test, and prints how it ended; of a test that did not pass, all its output.
    fn run(&self, worker: usize, limit: Duration) -> Counts {
        let started = Instant::now();
        let (counts, output) =
            self.attempt(worker, limit).unwrap_or_else(|error| (Counts::FAILED, format!("{error:#}\n")));
        let verdict = match counts {
            Counts::PASSED => "ok",
            Counts { failed: 0, .. } => "left out",
            _ => "FAILED",
        };
        let not_judged = output.lines().find(|line| line.starts_with(NOT_JUDGED));
        let taken = taken(started.elapsed());
        match not_judged.filter(|_| counts == Counts::PASSED) {
            Some(reason) => {
                println!("test {self} ... {reason}, {taken}");
                Counts::NOT_JUDGED
            }
            None => {
                let output = if verdict == "FAILED" { &output } else { "" };
                println!("{output}test {self} ... {verdict}, {taken}");
                counts
            }
        }
    }

    /// Runs the test once. Returns its counts and output.
    fn attempt(&self, worker: usize, limit: Duration) -> Result<(Counts, String)> {
        // A file, for what outlives the test would hold the end of a pipe.
        let mut output = tempfile::tempfile()?;
        let mut process = command(&self.program.path, "");
        process.args(["--exact", &self.name]).current_dir(&self.program.folder);
        process.envs(self.program.environment()).env("LASHLOOP_WORKER", worker.to_string());
        process.stdout(output.try_clone()?).stderr(output.try_clone()?);
        let mut child = process.spawn().with_context(|| cannot_start(&process))?;
        let in_time = self.ends_in_time(&child, limit)?;
        if !in_time {
            kill_family(Pid::from_child(&child));
        }
        let status = child.wait()?;
        let mut text = text_of(&mut output)?;
        let mut counts = text.lines().filter_map(Counts::of_libtest).next_back().unwrap_or_default();
        if !in_time {
            text += &format!("killed at its limit of {} s\n", limit.as_secs());
            counts = Counts::FAILED;
        } else if counts == Counts::default() || (!status.success() && counts.failed == 0) {
            text += &format!("ended with {status}\n");
            counts = Counts::FAILED;
        }
        Ok((counts, text))
    }

    /// Waits for the end, and returns whether it came in time. Prints the name of a test that has passed half of its time.
    fn ends_in_time(&self, child: &Child, limit: Duration) -> Result<bool> {
        let end = pidfd_open(Pid::from_child(child), PidfdFlags::empty())?;
        let started = Instant::now();
        if is_ready_within(&end, limit / 2)? {
            return Ok(true);
        }
        let half_s = limit.as_secs() / 2;
        println!("test {self} has taken {half_s} s, half of its limit");
        loop {
            let left = limit.mul_f64(programs_per_core()).saturating_sub(started.elapsed());
            if left.is_zero() || is_ready_within(&end, left)? {
                return Ok(!left.is_zero());
            }
        }
    }
}

/// Largest factor by which the load extends the limit of a test: the processes of a hung test are load too.
const MOST_PER_CORE: f64 = 3.0;

/// Programs that want a core, for each core, over the last minute; at least one. They share the time of a test.
fn programs_per_core() -> f64 {
    let load = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').next().and_then(|load| load.parse::<f64>().ok()).unwrap_or_default();
    let cores = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    (load / cores as f64).clamp(1.0, MOST_PER_CORE)
}

/// Kills a process and all that it has started. They are in the process group of this program, so that Ctrl-C ends all.
fn kill_family(parent: Pid) {
    let id = parent.as_raw_nonzero();
    let children = fs::read_to_string(format!("/proc/{id}/task/{id}/children")).unwrap_or_default();
    let _ = kill_process(parent, Signal::KILL);
    for child in children.split_whitespace().filter_map(|id| Pid::from_raw(id.parse().ok()?)) {
        kill_family(child);
    }
}

fn is_ready_within(end: &impl std::os::fd::AsFd, limit: Duration) -> Result<bool> {
    let deadline = Instant::now() + limit;
    loop {
        let left = deadline.saturating_duration_since(Instant::now());
        let left = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: left.subsec_nanos().into() };
        match poll(&mut [PollFd::new(end, PollFlags::IN)], Some(&left)) {
            Ok(ready) => return Ok(ready > 0),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
}

fn text_of(output: &mut File) -> Result<String> {
    let mut bytes = Vec::new();
    output.rewind()?;
    output.read_to_end(&mut bytes)?;
    // A test may print bytes that are not UTF-8.
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::{Conditions, Test, run_each};
    use crate::counts::Counts;
    use crate::log::duration;
    use crate::test_programs::tests::script;

    const CONDITIONS: Conditions =
        Conditions { at_once: 2, limit: Duration::from_secs(60), has_second_attempt: true };

    /// Test `a` fails at its first attempt, `b` always, `c` passes, `d` gives no verdict, `e` dies, `f` does not exist.
    const SCRIPT: &str = "ok='test result: ok. 1 passed; 0 failed; 0 ignored'
        bad='test result: FAILED. 0 passed; 1 failed; 0 ignored'
        case \"$2\" in
        a) if [ -e a ]; then echo $ok; else touch a; echo $bad; exit 101; fi;;
        b) echo $bad; exit 101;;
        c) echo $ok;;
        d) echo 'not judged: the witness was 30 ms late'; echo $ok;;
        e) kill -9 $$;;
        f) echo 'test result: ok. 0 passed; 0 failed; 0 ignored';;
        g) exec sleep 1000;;
        esac";

    /// The counts of these tests.
    fn counts(names: &str, conditions: Conditions) -> Counts {
        let (_folder, program) = script(SCRIPT);
        let tests: Vec<_> =
            names.chars().map(|name| Test { program: &program, name: name.to_string() }).collect();
        run_each(&tests, conditions)
    }

    #[test]
    fn a_test_that_fails_twice_has_failed_and_one_that_fails_once_has_passed() {
        assert_eq!(counts("abc", CONDITIONS), Counts { passed: 2, failed: 1, ..Counts::default() });
        let once = Conditions { has_second_attempt: false, ..CONDITIONS };
        assert_eq!(counts("abc", once), Counts { passed: 1, failed: 2, ..Counts::default() });
    }

    #[test]
    fn many_failures_get_no_second_attempt() {
        assert_eq!(counts("abbb", CONDITIONS), Counts { failed: 4, ..Counts::default() });
    }

    #[test]
    fn a_test_without_a_verdict_has_neither_passed_nor_failed() {
        let sum = counts("cd", CONDITIONS);
        assert_eq!(sum, Counts { passed: 1, not_judged: 1, ..Counts::default() });
    }

    #[test]
    fn a_process_that_dies_or_runs_no_test_has_failed() {
        assert_eq!(counts("ef", CONDITIONS), Counts { failed: 2, ..Counts::default() });
    }

    #[test]
    fn a_test_that_never_ends_is_killed_at_its_limit_with_what_it_started() {
        let started = Instant::now();
        let limit = Duration::from_millis(200);
        let sum = counts("g", Conditions { limit, has_second_attempt: false, ..CONDITIONS });
        assert_eq!(sum, Counts::FAILED);
        assert!(started.elapsed() < CONDITIONS.limit, "{:?}", started.elapsed());
    }

    #[test]
    fn the_duration_is_read_from_the_line_of_a_test() {
        for (line, read) in [
            ("test tests looped: soak::a_minute ... ok, 61.20 s", (61.2, "tests looped: soak::a_minute")),
            ("test a: b ... not judged: 30 ms late, 1.00 s", (1.0, "a: b")),
            ("2.31s call     tests/test_link.py::test_pause", (2.31, "tests/test_link.py::test_pause")),
        ] {
            assert_eq!(duration(line), Some(read));
        }
        for line in ["test result: ok. 3 passed", "(12 durations < 0.005s hidden.)", "test a ... ok"] {
            assert_eq!(duration(line), None, "{line}");
        }
    }
}
