//! The test programs of the workspace, as cargo builds them.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::command::{cargo, command, output, run};
use crate::counts::Counts;
use crate::log::taken;
use crate::{paths, slurm, usb_guest};

/// The test program of the Linux guest.
pub(crate) const USB: &str = "tests usb";

/// The test program of campaigns on a cluster.
pub(crate) const CLUSTER: &str = "tests cluster";

pub(crate) struct TestProgram {
    /// Folder of the package and name of the program: `host/bench scenario`.
    pub(crate) name: String,
    pub(crate) path: PathBuf,
    /// The folder of the package, which tests expect as their working directory.
    pub(crate) folder: PathBuf,
}

/// Builds all test programs, and the programs that they start.
///
/// # Errors
/// They don't build, or cargo lists none.
pub(crate) fn build() -> Result<Vec<TestProgram>> {
    let programs = build_with(cargo("test --workspace"))?;
    run(&mut cargo("programs --quiet"))?;
    Ok(programs)
}

/// Builds the test programs of a `cargo test`.
///
/// # Errors
/// As [`build`].
pub(crate) fn build_with(mut test: Command) -> Result<Vec<TestProgram>> {
    test.args(["--no-run", "--message-format", "json-render-diagnostics"]);
    let messages = output(test.stderr(Stdio::inherit()))?;
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

    /// The names of the tests of a program with the harness of Rust.
    ///
    /// # Errors
    /// The program can't be run.
    pub(crate) fn tests(&self) -> Result<Vec<String>> {
        let list = output(command(&self.path, "--list --format terse").current_dir(&self.folder))?;
        let names = list.lines().filter_map(|line| line.strip_suffix(": test"));
        Ok(names.map(str::to_owned).collect())
    }

    /// Runs all tests of a program with a harness of its own, whose tests share what takes long to start. The time of a test
    /// is that since the test before.
    ///
    /// # Errors
    /// The program can't be run.
    pub(crate) fn run_whole(&self) -> Result<Counts> {
        let mut tests = command(&self.path, "");
        tests.current_dir(&self.folder).envs(self.environment());
        let mut since = Instant::now();
        Counts::of_output(tests, Counts::of_libtest, |line| {
            let test = line.strip_prefix("test ").filter(|line| line.contains(" ... "));
            match test {
                Some(test) => println!("test {}: {test}, {}", self.name, taken(since.elapsed())),
                None => println!("{line}"),
            }
            if test.is_some() {
                since = Instant::now();
            }
        })
    }

    /// What its tests learn of their environment.
    pub(crate) fn environment(&self) -> Vec<(&str, &str)> {
        let folder = self.folder.to_str().map(|folder| ("CARGO_MANIFEST_DIR", folder));
        let mut variables = vec![("LASHLOOP_PROGRAMS_ARE_BUILT", "1")];
        variables.extend(folder);
        // Tests fail where their equipment is missing, but for the guest and Slurm, whose packages a machine may not be able to
        // download: they are counted as left out.
        let is_required = match self.name.as_str() {
            USB => usb_guest::is_set_up(),
            CLUSTER => slurm::is_set_up(),
            _ => true,
        };
        if is_required {
            variables.push(("LASHLOOP_REQUIRE_EQUIPMENT", "1"));
        }
        variables
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use std::fs::{self, Permissions};
    use std::os::unix::fs::PermissionsExt;

    use serde_json::json;

    use super::TestProgram;
    use crate::counts::Counts;
    use crate::paths;

    /// A shell script that acts as a test program.
    pub(crate) fn script(text: &str) -> (tempfile::TempDir, TestProgram) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("tests");
        fs::write(&path, format!("#!/bin/sh\n{text}\n")).expect("a script");
        fs::set_permissions(&path, Permissions::from_mode(0o755)).expect("a script that runs");
        let program = TestProgram { name: "script".to_owned(), path, folder: folder.path().to_owned() };
        (folder, program)
    }

    #[test]
    fn the_tests_of_a_program_are_listed_and_its_benchmarks_are_not() {
        let (_folder, program) = script("printf 'a::b: test\\nc: benchmark\\nd: test\\n'");
        let tests = program.tests().expect("a list");
        assert_eq!(tests, ["a::b", "d"]);
    }

    #[test]
    fn a_program_with_a_harness_of_its_own_runs_once() {
        let (_folder, program) =
            script("echo 'test result: FAILED. 3 passed; 1 failed; 2 ignored'; exit 101");
        let counts = program.run_whole().expect("a script");
        assert_eq!(counts, Counts { passed: 3, failed: 1, left_out: 2, not_judged: 0 });
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
