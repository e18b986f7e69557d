//! The test programs of the workspace, as cargo builds them.

use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::command::{cargo, command, output};
use crate::counts::Counts;
use crate::paths;

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

    /// Runs the program and counts its tests.
    pub(crate) fn run(&self, arguments: &str) -> Result<Counts> {
        let mut tests = command(&self.path, arguments);
        tests.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder);
        // Tests fail where their equipment is missing, instead of being omitted.
        tests.env("LASHLOOP_REQUIRE_EQUIPMENT", "1");
        let counts = Counts::of_output(tests, Counts::of_libtest, |line| println!("{line}"))?;
        let has_run = arguments.is_empty() || counts != Counts::default();
        ensure!(has_run, "no test of {} matches {arguments}", self.name);
        Ok(counts)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::TestProgram;
    use crate::paths;

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
