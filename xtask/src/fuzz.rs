//! A bounded run of every fuzzer in `fuzz/`.
//!
//! Our code has no unsafe block for a sanitizer to watch, so the fuzzers are built without one. Then they need neither a
//! nightly compiler nor cargo-fuzz, whose flags for coverage are below: a C++ compiler for libFuzzer is enough.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context, Result, bail, ensure};
use regex_lite::Regex;

use crate::command::{cannot_start, cargo, command, first_line, name, run};
use crate::counts::Counts;
use crate::paths;

/// A program of `fuzz/`, and the length of its longest input in bytes. Records and campaigns need their whole seed; longer seeds of the
/// others are cut, and a test replays those of the drive whole. The time of an execution grows with the input.
const TARGETS: [(&str, u32); 11] = [
    ("decoder", 160),
    ("frames", 192),
    ("drive", 128),
    ("session", 128),
    ("scenario", 4096),
    ("record", 4096),
    ("campaign", 2048),
    ("shard", 512),
    ("rig", 1024),
    ("pcapng", 512),
    ("elf", 512),
];

/// What `cargo fuzz build --sanitizer none` passes to the compiler, without the hooks at comparisons and the depth of the stack: they
/// cost more than the code between them. A comparison with a CRC or an enum doesn't stop them, because the targets make frames of bodies.
const COVERAGE: &str = "--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=3 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table";

/// Edges alone guide the search, without their counts and without the entropy of inputs. libFuzzer keeps books on each feature of an
/// execution, which takes longer than the execution itself: a state machine of few loops has nothing to gain from it.
const OPTIONS: &str = "-timeout=10 -verbosity=0 -print_final_stats=1 -use_counters=0 -entropic=0 -reduce_inputs=0 \
    -len_control=0 -reload=0";

/// Gives every fuzzer `seconds` to find an input that breaks a promise, and prints how many it has tried.
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
    let programs = &folder().join(triple).join("release");
    let (mut counts, mut sum) = (Counts::default(), 0);
    thread::scope(|scope| {
        let fuzzers = TARGETS
            .map(|(target, max_len)| (target, scope.spawn(move || fuzz(programs, target, max_len, seconds))));
        for (target, fuzzer) in fuzzers {
            counts.step(&format!("fuzz {target}, {seconds} s"), || {
                let executions = fuzzer.join().unwrap_or_else(|_| bail!("its thread panicked"))?;
                sum += executions;
                println!("{target}: {}", rate(executions, seconds));
                Ok(())
            });
        }
    });
    report(&format!("fuzzers: {}", rate(sum, seconds)))?;
    Ok(counts)
}

/// Runs one fuzzer and returns the number of its executions.
///
/// # Errors
/// The fuzzer found an input, executed none, or can't be run.
fn fuzz(programs: &Path, target: &str, max_len: u32, seconds: u32) -> Result<u64> {
    let sources = paths::root().join("fuzz");
    let (corpus, artifacts) = (folder().join("corpus").join(target), sources.join("artifacts").join(target));
    for folder in [&corpus, &artifacts] {
        fs::create_dir_all(folder).with_context(|| format!("{} can't be created", folder.display()))?;
    }
    let mut fuzzer = command(programs.join(target), OPTIONS);
    fuzzer.current_dir(&sources).arg(format!("-max_total_time={seconds}")).arg(format!("-max_len={max_len}"));
    fuzzer.arg(format!("-artifact_prefix={}/", artifacts.display()));
    fuzzer.arg(corpus).arg(sources.join("corpus").join(target));
    let ended = fuzzer.output().with_context(|| cannot_start(&fuzzer))?;
    let printed = String::from_utf8_lossy(&ended.stderr);
    ensure!(
        ended.status.success(),
        "{} ended with {}; its input is in {}\n{printed}",
        name(&fuzzer),
        ended.status,
        artifacts.display()
    );
    let executions = executions(&printed).context("libFuzzer printed no number of executions")?;
    ensure!(executions > 0, "no execution in {seconds} s");
    Ok(executions)
}

/// `stat::number_of_executed_units: 1028719`
fn executions(printed: &str) -> Option<u64> {
    let (_, [executions]) =
        Regex::new(r"stat::number_of_executed_units:\s+(\d+)").ok()?.captures(printed)?.extract();
    executions.parse().ok()
}

/// The number of executions and their rate in millions per second.
fn rate(executions: u64, seconds: u32) -> String {
    let per_second = executions as f64 / f64::from(seconds.max(1));
    format!("{executions} executions in {seconds} s, {:.3} M/s", per_second / 1e6)
}

/// Prints a line, and leaves it where `cargo xtask test` collects the reports of its chores.
fn report(line: &str) -> Result<()> {
    println!("{line}");
    let reports = paths::root().join("target/reports");
    fs::create_dir_all(&reports)?;
    Ok(fs::write(reports.join("fuzz.txt"), format!("{line}\n"))?)
}

fn folder() -> PathBuf {
    paths::root().join("target/fuzz")
}

#[cfg(test)]
mod tests {
    use super::{executions, rate};

    #[test]
    fn executions_are_read_from_the_statistics() {
        let printed =
            "Done 7 in 3 s\nstat::number_of_executed_units: 1028719\nstat::average_exec_per_sec:     9\n";
        assert_eq!(executions(printed), Some(1_028_719));
        assert_eq!(executions("stat::average_exec_per_sec: 9"), None);
        assert_eq!(rate(30_000_000, 20), "30000000 executions in 20 s, 1.500 M/s");
    }
}
