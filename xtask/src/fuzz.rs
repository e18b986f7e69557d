//! A bounded run of every fuzzer in `fuzz/`.
//!
//! Our code has no unsafe block for a sanitizer to watch, so the fuzzers are built without one. Then they need neither a
//! nightly compiler nor cargo-fuzz, whose flags for coverage are below: a C++ compiler for libFuzzer is enough.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context, Result, bail};

use crate::command::{cargo, command, first_line, run};
use crate::counts::Counts;
use crate::paths;

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
pub(crate) fn run_all(seconds: u32) -> Result<Counts> {
    let triple =
        first_line(&mut command("rustc", "--print host-tuple")).context("rustc prints no host tuple")?;
    // The target triple is named, so that the flags don't apply to build scripts.
    let build = "build --locked --release --manifest-path fuzz/Cargo.toml --bins --target";
    run(cargo(build).arg(&triple).arg("--target-dir").arg(folder()).env("RUSTFLAGS", COVERAGE)).context(
        "the fuzzers don't build; if the C++ compiler for libFuzzer is missing, install one (g++ on Debian)",
    )?;
    let programs = folder().join(triple).join("release");
    let mut counts = Counts::default();
    thread::scope(|scope| {
        let fuzzers = TARGETS.map(|target| (target, scope.spawn(|| fuzz(&programs, target, seconds))));
        for (target, fuzzer) in fuzzers {
            counts.step(&format!("fuzz {target}, {seconds} s"), || {
                fuzzer.join().unwrap_or_else(|_| bail!("its thread panicked"))
            });
        }
    });
    Ok(counts)
}

/// # Errors
/// The fuzzer found an input, or can't be run.
fn fuzz(programs: &Path, target: &str, seconds: u32) -> Result<()> {
    let sources = paths::root().join("fuzz");
    let (corpus, artifacts) = (folder().join("corpus").join(target), sources.join("artifacts").join(target));
    for folder in [&corpus, &artifacts] {
        fs::create_dir_all(folder).with_context(|| format!("{} can't be created", folder.display()))?;
    }
    let mut fuzzer = command(programs.join(target), "-timeout=10 -verbosity=0 -print_final_stats=1");
    fuzzer.current_dir(&sources).arg(format!("-max_total_time={seconds}"));
    fuzzer.arg(format!("-artifact_prefix={}/", artifacts.display()));
    run(fuzzer.arg(corpus).arg(sources.join("corpus").join(target)))
        .with_context(|| format!("its input is in {}", artifacts.display()))
}

fn folder() -> PathBuf {
    paths::root().join("target/fuzz")
}
