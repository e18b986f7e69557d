//! The test programs of the workspace, as cargo builds them.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::command::{cargo, command, output};
use crate::counts::Counts;
use crate::{paths, slurm, usb_guest};

/// The test program of the Linux guest.
pub(crate) const USB: &str = "tests usb";

/// The test program of campaigns on a cluster.
pub(crate) const CLUSTER: &str = "tests cluster";

/// Most failed tests of a program that get a second attempt.
const SECOND_ATTEMPTS: usize = 3;

pub(crate) struct TestProgram {
    /// Folder of the package and name of the program: `host/bench scenario`.
    pub(crate) name: String,
    path: PathBuf,
    /// The folder of the package, which tests expect as their working directory.
    folder: PathBuf,
}

/// Builds all test programs.
///
/// # Errors
/// They don't build, or cargo lists none.
pub(crate) fn build() -> Result<Vec<TestProgram>> {
    let mut build = cargo("test --workspace --no-run --message-format json-render-diagnostics");
    let messages = output(build.stderr(Stdio::inherit()))?;
    let messages = messages.lines().map(serde_json::from_str).collect::<Result<Vec<Value>, _>>();
    let messages = messages.context("the messages of cargo aren't JSON")?;
    let programs: Vec<_> = messages.iter().filter_map(TestProgram::of).collect();
    ensure!(!programs.is_empty(), "cargo lists no test program");
    Ok(programs)
}

impl TestProgram {
    /// Reads one message of cargo; `None` if it isn't about a test program.
    fn of(message: &Value) -> Option<Self> {
        let path = message["executable"].as_str().filter(|_| message["profile"]["test"] == true)?;
        let folder = Path::new(message["manifest_path"].as_str()?).parent()?;
        let package = folder.strip_prefix(paths::root()).ok()?;
        let name = format!("{} {}", package.display(), message["target"]["name"].as_str()?);
        Some(Self { name, path: path.into(), folder: folder.to_owned() })
    }

    /// Runs the program, prints its output at its end, and counts its tests.
    pub(crate) fn run(&self, arguments: &str) -> Counts {
        let started = Instant::now();
        let mut output = format!("== {}\n", self.name);
        let counts = self.attempt(arguments, |line| {
            let _ = writeln!(output, "{line}");
        });
        print!("{output}");
        let counts = counts.unwrap_or_else(|error| Counts::failed(&self.name, &error));
        println!("{}: {:.0?}", self.name, started.elapsed());
        counts
    }

    /// Runs the program like [`run`](Self::run), and each test that fails once more by itself: on a machine that others use, a
    /// stall of some 100 ms fails a test of real time or of another process. What fails twice has failed; what passes then
    /// is reported by name.
    pub(crate) fn run_on_shared_machine(&self, arguments: &str) -> Result<Counts> {
        let mut failed = Vec::new();
        let mut counts = self.attempt(arguments, |line| {
            println!("{line}");
            failed.extend(failed_test(line).map(str::to_owned));
        })?;
        // More than a few are no stall.
        if failed.len() > SECOND_ATTEMPTS {
            return Ok(counts);
        }
        for name in &failed {
            let again = self.attempt(&format!("--exact {name}"), |line| println!("{line}"))?;
            let passes = again == Counts::PASSED;
            println!("second attempt of {name}: {}", if passes { "passed" } else { "not passed" });
            if passes {
                counts.passed += 1;
                counts.failed = counts.failed.saturating_sub(1);
            }
        }
        Ok(counts)
    }

    fn attempt(&self, arguments: &str, print: impl FnMut(&str)) -> Result<Counts> {
        let mut tests = command(&self.path, arguments);
        tests.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder);
        // Tests fail where their equipment is missing, but for the guest and Slurm, whose packages a machine may not be able to
        // download: they are counted as left out.
        let is_required = match self.name.as_str() {
            USB => usb_guest::is_set_up(),
            CLUSTER => slurm::is_set_up(),
            _ => true,
        };
        if is_required {
            tests.env("LASHLOOP_REQUIRE_EQUIPMENT", "1");
        }
        let counts = Counts::of_output(tests, Counts::of_libtest, print)?;
        let has_run = arguments.is_empty() || counts != Counts::default();
        ensure!(has_run, "no test of {} matches {arguments}", self.name);
        Ok(counts)
    }
}

/// The name in the line of a test that failed.
fn failed_test(line: &str) -> Option<&str> {
    line.strip_prefix("test ")?.strip_suffix(" ... FAILED").map(str::trim_end)
}

#[cfg(test)]
mod tests {
    use std::fs::{self, Permissions};
    use std::os::unix::fs::PermissionsExt;

    use serde_json::json;

    use super::TestProgram;
    use crate::counts::Counts;
    use crate::paths;

    /// A shell script in place of a test program.
    fn script(text: &str) -> (tempfile::TempDir, TestProgram) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("tests");
        fs::write(&path, format!("#!/bin/sh\n{text}\n")).expect("a script");
        fs::set_permissions(&path, Permissions::from_mode(0o755)).expect("a script that runs");
        let program = TestProgram { name: "script".to_owned(), path, folder: folder.path().to_owned() };
        (folder, program)
    }

    /// Of the tests `a`, `b`, `c` two fail at the first attempt, and `b` for good.
    const ONE_STALL: &str = "case \"$*\" in
        *--exact\\ a) echo 'test result: ok. 1 passed; 0 failed; 0 ignored';;
        *--exact\\ b) echo 'test result: FAILED. 0 passed; 1 failed; 0 ignored'; exit 101;;
        *) echo 'test a ... FAILED'; echo 'test b ... FAILED'; echo 'test c ... ok'
           echo 'test result: FAILED. 1 passed; 2 failed; 0 ignored'; exit 101;;
        esac";

    #[test]
    fn a_test_that_fails_twice_has_failed_and_one_that_fails_once_has_passed() {
        let (_folder, program) = script(ONE_STALL);
        let run = program.run_on_shared_machine("").expect("a script");
        assert_eq!(run, Counts { passed: 2, failed: 1, left_out: 0 });
        assert_eq!(program.run(""), Counts { passed: 1, failed: 2, left_out: 0 });
    }

    #[test]
    fn a_filter_that_matches_no_test_is_an_error() {
        let (_folder, program) = script("echo 'test result: ok. 0 passed; 0 failed; 0 ignored; 0 measured'");
        assert_eq!(program.run("wire::"), Counts::FAILED);
        assert!(program.run_on_shared_machine("wire::").is_err());
        assert_eq!(program.run(""), Counts::default());
    }

    #[test]
    fn a_program_that_fails_in_many_tests_gets_no_second_attempt() {
        let (_folder, program) = script(
            "case \"$*\" in *--exact*) echo 'test result: ok. 1 passed; 0 failed; 0 ignored'; exit;; esac
            for i in 1 2 3 4; do echo \"test a$i ... FAILED\"; done
            echo 'test result: FAILED. 0 passed; 4 failed; 0 ignored'; exit 101",
        );
        let run = program.run_on_shared_machine("").expect("a script");
        assert_eq!(run, Counts { passed: 0, failed: 4, left_out: 0 });
    }

    #[test]
    fn a_test_program_is_read_from_a_message_of_cargo() {
        let folder = paths::root().join("host/bench");
        let message = |is_test: bool| {
            json!({
                "reason": "compiler-artifact",
                "manifest_path": folder.join("Cargo.toml"),
                "target": { "name": "scenario" },
                "profile": { "test": is_test },
                "executable": "/target/debug/deps/scenario-1",
            })
        };
        let program = TestProgram::of(&message(true)).expect("a program");
        assert_eq!(program.name, "host/bench scenario");
        assert_eq!(program.folder, folder);
        assert!(TestProgram::of(&message(false)).is_none());
    }
}
