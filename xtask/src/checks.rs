//! What can be judged without running a test.

use std::process::{Command, ExitCode};

use anyhow::{Result, ensure};

use crate::tally::Tally;
use crate::{command, directions, lines, words};

/// Runs all checks. The last line printed is the sum.
pub(crate) fn run() -> ExitCode {
    let mut tally = Tally::default();
    tally.step("lockfile", lockfile);
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

const ALL_TARGETS: [&str; 2] = ["--workspace", "--all-targets"];

/// The cargo that started us has updated an old `Cargo.lock` already. The sign is a change without a changed manifest.
fn lockfile() -> Result<()> {
    let changed = |path| command::output(command::git().args(["diff", "--name-only", "HEAD", "--", path]));
    let is_updated = !changed("Cargo.lock")?.is_empty() && changed("*Cargo.toml")?.is_empty();
    ensure!(
        !is_updated,
        "the committed Cargo.lock doesn't fit the manifests: commit the one that cargo wrote"
    );
    Ok(())
}

fn cargo(chore: &str) -> Command {
    let mut command = command::cargo();
    command.arg(chore);
    command
}
