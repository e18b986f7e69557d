//! The test programs of the workspace, as cargo builds them.

use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::command;
use crate::test_counts::Counts;

pub(crate) struct TestProgram {
    pub(crate) package: String,
    pub(crate) target: String,
    path: PathBuf,
    /// The folder of the package, which tests expect as their working directory.
    folder: PathBuf,
}

/// Builds all test programs.
///
/// # Errors
/// They don't build, or cargo lists none.
pub(crate) fn build() -> Result<Vec<TestProgram>> {
    let messages = command::output(command::cargo().args([
        "test",
        "--workspace",
        "--no-run",
        "--message-format",
        "json-render-diagnostics",
    ]))?;
    let messages = messages.lines().map(serde_json::from_str).collect::<Result<Vec<Value>, _>>();
    let messages = messages.context("the messages of cargo aren't JSON")?;
    let programs: Vec<_> = messages.iter().filter_map(TestProgram::of).collect();
    ensure!(!programs.is_empty(), "cargo lists no test program");
    Ok(programs)
}

/// Runs the examples in doc comments.
pub(crate) fn documentation() -> Result<Counts> {
    let mut tests = command::cargo();
    tests.args(["test", "--workspace", "--doc", "--no-fail-fast"]);
    run(&mut tests)
}

impl TestProgram {
    /// Reads one message of cargo; `None` if it isn't about a test program.
    fn of(message: &Value) -> Option<Self> {
        let path = message["executable"].as_str().filter(|_| message["profile"]["test"] == true)?;
        let folder = Path::new(message["manifest_path"].as_str()?).parent()?;
        // path+file:///workspace/host#lashloop@0.1.0, or without the name where the folder has it.
        let (url, name) = message["package_id"].as_str()?.rsplit_once('#')?;
        let package = name.split_once('@').map_or_else(|| url.rsplit('/').next(), |(name, _)| Some(name))?;
        Some(Self {
            package: package.to_owned(),
            target: message["target"]["name"].as_str()?.to_owned(),
            path: path.into(),
            folder: folder.to_owned(),
        })
    }

    /// Runs the program and counts its tests.
    pub(crate) fn run(&self, arguments: &[&str]) -> Result<Counts> {
        let mut tests = Command::new(&self.path);
        tests.args(arguments).current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder);
        let counts = run(&mut tests)?;
        let has_run = arguments.is_empty() || counts != Counts::default();
        ensure!(has_run, "no test of {} matches {}", self.target, arguments.join(" "));
        Ok(counts)
    }
}

fn run(tests: &mut Command) -> Result<Counts> {
    // Tests fail where their equipment is missing, instead of being omitted.
    tests.env("LASHLOOP_LEAVE_NOTHING_OUT", "1").stdin(Stdio::null()).stdout(Stdio::piped());
    let mut child = tests.spawn().with_context(|| command::cannot_start(tests))?;
    let stdout = child.stdout.take().context("the output of the tests was not kept")?;
    let counts = Counts::of_stream(BufReader::new(stdout), io::stdout())?;
    let status = child.wait()?;
    // A program that a signal ends prints no result.
    if !status.success() && counts.failed == 0 {
        println!("{} ended with {status}", command::name(tests));
        return Ok(Counts { failed: 1, ..counts });
    }
    Ok(counts)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::TestProgram;

    #[test]
    fn a_test_program_is_read_from_a_message_of_cargo() {
        let message = |id: &str, is_test: bool| {
            json!({
                "reason": "compiler-artifact",
                "package_id": id,
                "manifest_path": "/w/host/Cargo.toml",
                "target": { "name": "tools" },
                "profile": { "test": is_test },
                "executable": "/w/target/debug/deps/tools-1",
            })
        };
        let program =
            TestProgram::of(&message("path+file:///w/host#lashloop@0.1.0", true)).expect("a program");
        assert_eq!((program.package.as_str(), program.target.as_str()), ("lashloop", "tools"));
        assert_eq!(program.folder.to_str(), Some("/w/host"));
        let program = TestProgram::of(&message("path+file:///w/tests#0.1.0", true)).expect("a program");
        assert_eq!(program.package, "tests");
        assert!(TestProgram::of(&message("path+file:///w/host#lashloop@0.1.0", false)).is_none());
    }
}
