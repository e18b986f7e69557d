//! A bounded run of every fuzzer in `fuzz/`.
//!
//! Our code has no unsafe block for a sanitizer to watch, so the fuzzers are built without one. Then they need neither a
//! nightly compiler nor cargo-fuzz, whose flags for coverage are below: a C++ compiler for libFuzzer is enough.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::test_counts::Counts;
use crate::{command, paths};

const TARGETS: [&str; 3] = ["decoder", "drive", "scenario"];

/// What `cargo fuzz build --sanitizer none` passes to the compiler.
const COVERAGE: &str = "--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares -Cllvm-args=-sanitizer-coverage-stack-depth -Clink-dead-code \
    -Ccodegen-units=1";

/// Gives every fuzzer `seconds` to find an input that breaks a promise.
///
/// New inputs stay in `target/fuzz/corpus` for the next run; the committed seeds stay as they are.
///
/// # Errors
/// The fuzzers can't be built.
pub(crate) fn run(seconds: u32) -> Result<Counts> {
    let triple = command::first_line(command::rustc().args(["--print", "host-tuple"]));
    let triple = triple.context("rustc prints no host tuple")?;
    // The target is named, so that the flags don't apply to build scripts.
    let mut build = command::cargo();
    build.args([
        "build",
        "--locked",
        "--release",
        "--bins",
        "--manifest-path",
        "fuzz/Cargo.toml",
        "--target",
        &triple,
    ]);
    build.arg("--target-dir").arg(folder()).env("RUSTFLAGS", COVERAGE);
    command::run(&mut build).context(
        "the fuzzers don't build; if the C++ compiler for libFuzzer is missing, install one (g++ on Debian)",
    )?;
    let programs = folder().join(triple).join("release");
    let mut counts = Counts::default();
    for target in TARGETS {
        println!("== fuzz {target}, {seconds} s");
        match fuzz(&programs, target, seconds) {
            Ok(()) => counts.passed += 1,
            Err(error) => {
                println!("fuzz {target} failed: {error:#}");
                counts.failed += 1;
            }
        }
    }
    Ok(counts)
}

/// # Errors
/// The fuzzer found an input, or can't be run.
fn fuzz(programs: &Path, target: &str, seconds: u32) -> Result<()> {
    let corpus = folder().join("corpus").join(target);
    let artifacts = paths::root().join("fuzz/artifacts").join(target);
    for folder in [&corpus, &artifacts] {
        fs::create_dir_all(folder).with_context(|| format!("{} can't be created", folder.display()))?;
    }
    let mut fuzzer = Command::new(programs.join(target));
    fuzzer.current_dir(paths::root().join("fuzz"));
    fuzzer.arg(format!("-artifact_prefix={}/", artifacts.display()));
    fuzzer.arg(format!("-max_total_time={seconds}"));
    fuzzer.args(["-timeout=10", "-verbosity=0", "-print_final_stats=1"]);
    fuzzer.arg(corpus).arg(paths::root().join("fuzz/corpus").join(target));
    command::run(&mut fuzzer).with_context(|| format!("its input is in {}", artifacts.display()))
}

fn folder() -> PathBuf {
    paths::root().join("target/fuzz")
}
