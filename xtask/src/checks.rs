//! What can be judged without running a test.

use std::process::{Command, ExitCode};

use crate::tally::Tally;
use crate::{command, directions, lines, words};

/// Runs all checks. The last line printed is the sum.
pub(crate) fn run() -> ExitCode {
    let mut tally = Tally::default();
    tally.step("lockfile", || command::output(cargo("metadata").args(LOCKED)).map(drop));
    tally.step("format", || command::run(cargo("fmt").args(["--all", "--check"])));
    tally.step("words", words::check);
    tally.step("directions", directions::check);
    tally.step("lines", lines::check);
    tally.step("clippy", || command::run(cargo("clippy").args(ALL_TARGETS).args(["--", "-D", "warnings"])));
    tally.step("documentation", || {
        command::run(cargo("doc").args(["--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
    });
    tally.finish()
}

/// Fails where `Cargo.lock` doesn't fit the manifests.
const LOCKED: [&str; 3] = ["--locked", "--format-version", "1"];

const ALL_TARGETS: [&str; 2] = ["--workspace", "--all-targets"];

fn cargo(chore: &str) -> Command {
    let mut command = command::cargo();
    command.arg(chore);
    command
}
