//! A bounded run of every fuzzer in `fuzz/`.
//!
//! Our code has no unsafe block for a sanitizer to watch, so the fuzzers are built without one: then they need no
//! nightly compiler, only the one that called us and a C++ compiler for libFuzzer.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::{command, paths};

const TARGETS: [&str; 3] = ["decoder", "drive", "scenario"];

/// The version the fuzzers are known to run with; used where none is installed.
const CARGO_FUZZ_VERSION: &str = "0.13.2";

/// Gives every fuzzer `seconds` to find an input that breaks a promise.
///
/// What it learns stays in `target/fuzz`: the next run goes on from there, and the committed seeds stay as they are.
///
/// # Errors
/// What is missing and how to get it, or which fuzzer found something and where it lies.
pub(crate) fn run(seconds: u32) -> Result<()> {
    let program = cargo_fuzz()?;
    command::run(&mut fuzz(&program, "build")).context(
        "the fuzzers don't build; if the C++ compiler for libFuzzer is missing, install one (g++ on Debian)",
    )?;
    for target in TARGETS {
        println!("== fuzz {target}, {seconds} s");
        let learnt = paths::root().join("target/fuzz/corpus").join(target);
        fs::create_dir_all(&learnt).with_context(|| format!("{} cannot be made", learnt.display()))?;
        let seeds = paths::root().join("fuzz/corpus").join(target);
        let limits =
            [&format!("-max_total_time={seconds}"), "-timeout=10", "-verbosity=0", "-print_final_stats=1"];
        command::run(fuzz(&program, "run").arg(target).args([learnt, seeds]).arg("--").args(limits))
            .with_context(|| {
                format!("the fuzzer `{target}` broke it with the input in fuzz/artifacts/{target}")
            })?;
    }
    Ok(())
}

fn fuzz(program: &PathBuf, chore: &str) -> Command {
    let mut command = Command::new(program);
    command.current_dir(paths::root());
    command
        .args(["fuzz", chore, "--sanitizer", "none", "--target-dir"])
        .arg(paths::root().join("target/fuzz"));
    command
}

/// The installed one, or one of our own below `target`.
fn cargo_fuzz() -> Result<PathBuf> {
    if let Some(installed) = command::find_program("cargo-fuzz") {
        return Ok(installed);
    }
    let tools = paths::root().join("target/tools");
    let program = tools.join("bin/cargo-fuzz");
    if !program.is_file() {
        let mut install = command::cargo();
        install
            .args(["install", "cargo-fuzz", "--locked", "--version", CARGO_FUZZ_VERSION, "--root"])
            .arg(&tools);
        command::run(&mut install).context(
            "cargo-fuzz is missing and could not be installed: call `cargo install cargo-fuzz` yourself and try again",
        )?;
    }
    Ok(program)
}
