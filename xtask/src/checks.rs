//! What can be judged without running the product.

use std::fs;

use anyhow::{Result, ensure};

use crate::command::{cargo, command, output, run};
use crate::counts::Counts;
use crate::{dependencies, paths};

/// Runs all checks.
pub(crate) fn run_all() -> Counts {
    let mut counts = Counts::default();
    counts.step("lockfile", lockfile);
    counts.step("format", || run(&mut cargo("fmt --all --check")));
    counts.step("clippy", || run(&mut cargo("clippy --workspace --all-targets -- -D warnings")));
    counts
        .step("documentation", || run(cargo("doc --workspace --no-deps").env("RUSTDOCFLAGS", "-D warnings")));
    counts.step("benchmarks", benchmarks);
    counts.step("dependencies", dependencies::check);
    counts.step("planted dependencies", dependencies::finds_planted_breaks);
    // For the whole workspace, so that the dependencies have the features of every other test.
    counts.step("source tree", || {
        let tests = cargo("test --workspace --test tree");
        Counts::of_output(tests, Counts::of_libtest, |line| println!("{line}"))
    });
    counts
}

/// Compiles the benchmarks in Rust, which are workspaces of their own.
fn benchmarks() -> Result<()> {
    for benchmark in fs::read_dir(paths::root().join("benchmarks"))? {
        let manifest = benchmark?.path().join("Cargo.toml");
        if !manifest.exists() {
            continue;
        }
        let mut clippy = cargo("clippy --all-targets --locked --manifest-path");
        clippy.arg(manifest).args(["--", "-D", "warnings"]);
        run(clippy.env("CARGO_TARGET_DIR", paths::root().join("target/benchmarks")))?;
    }
    Ok(())
}

/// The cargo that started this program has updated an old `Cargo.lock` already. The sign is a change without a changed
/// manifest.
fn lockfile() -> Result<()> {
    let changed = |path| output(command("git", "diff --name-only HEAD --").arg(path));
    let is_updated = !changed("Cargo.lock")?.is_empty() && changed("*Cargo.toml")?.is_empty();
    ensure!(
        !is_updated,
        "the committed Cargo.lock doesn't fit the manifests: commit the one that cargo wrote"
    );
    Ok(())
}
