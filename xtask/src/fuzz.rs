//! A bounded run of every fuzzer in `fuzz/`.
//!
//! Our code has no unsafe block for a sanitizer to watch, so the fuzzers are built without one. Then they need neither a
//! nightly compiler nor cargo-fuzz, whose flags for coverage are below: a C++ compiler for libFuzzer is enough.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fmt, fs, thread};

use anyhow::{Context, Result, bail, ensure};
use regex_lite::Regex;

use crate::command::{cannot_start, cargo, command, first_line, run};
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
    let (mut counts, mut sum) = (Counts::default(), Effort::default());
    thread::scope(|scope| {
        let fuzzers = TARGETS
            .map(|(target, max_len)| (target, scope.spawn(move || fuzz(programs, target, max_len, seconds))));
        for (target, fuzzer) in fuzzers {
            counts.step(&format!("fuzz {target}, {seconds} s"), || {
                let effort = fuzzer.join().unwrap_or_else(|_| bail!("its thread panicked"))?;
                sum = Effort {
                    executions: sum.executions + effort.executions,
                    cpu_s: sum.cpu_s + effort.cpu_s,
                };
                println!("{target}: {effort}");
                Ok(())
            });
        }
    });
    report(&format!("fuzzers: {sum}"))?;
    Ok(counts)
}

/// What a fuzzer has done. Fuzzers share the cores, so the rate is that of processor time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Effort {
    executions: u64,
    cpu_s: f64,
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { executions, cpu_s } = self;
        write!(
            f,
            "{executions} executions in {cpu_s:.1} s of CPU, {:.0} a second",
            *executions as f64 / cpu_s.max(0.01)
        )
    }
}

/// Runs one fuzzer.
///
/// # Errors
/// The fuzzer found an input, executed none, or can't be run.
fn fuzz(programs: &Path, target: &str, max_len: u32, seconds: u32) -> Result<Effort> {
    let sources = paths::root().join("fuzz");
    let (corpus, artifacts) = (folder().join("corpus").join(target), sources.join("artifacts").join(target));
    for folder in [&corpus, &artifacts] {
        fs::create_dir_all(folder).with_context(|| format!("{} can't be created", folder.display()))?;
    }
    // A shell prints the processor time of what it has run.
    let mut fuzzer = Command::new("sh");
    fuzzer
        .args(["-c", r#""$@" || exit $?; times >&2"#, "sh"])
        .arg(programs.join(target))
        .args(OPTIONS.split(' '));
    fuzzer.current_dir(&sources).arg(format!("-max_total_time={seconds}")).arg(format!("-max_len={max_len}"));
    fuzzer.arg(format!("-artifact_prefix={}/", artifacts.display()));
    fuzzer.arg(corpus).arg(sources.join("corpus").join(target));
    let ended = fuzzer.output().with_context(|| cannot_start(&fuzzer))?;
    let printed = String::from_utf8_lossy(&ended.stderr);
    ensure!(
        ended.status.success(),
        "{target} ended with {}; its input is in {}\n{printed}",
        ended.status,
        artifacts.display()
    );
    let executions = executions(&printed).context("libFuzzer printed no number of executions")?;
    ensure!(executions > 0, "no execution in {seconds} s");
    let cpu_s = cpu_s(&printed).context("the shell printed no processor time")?;
    Ok(Effort { executions, cpu_s })
}

/// `0m9.991s 0m0.010s`, the user's and the system's time of the children, in the last line of `times`.
fn cpu_s(printed: &str) -> Option<f64> {
    let words = printed.lines().next_back()?.split_whitespace();
    words
        .map(|time| {
            let (minutes, seconds) = time.strip_suffix('s')?.split_once('m')?;
            Some(60.0 * minutes.parse::<f64>().ok()? + seconds.parse::<f64>().ok()?)
        })
        .sum()
}

/// `stat::number_of_executed_units: 1028719`
fn executions(printed: &str) -> Option<u64> {
    let (_, [executions]) =
        Regex::new(r"stat::number_of_executed_units:\s+(\d+)").ok()?.captures(printed)?.extract();
    executions.parse().ok()
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
    use super::{Effort, cpu_s, executions};

    #[test]
    fn executions_are_read_from_the_statistics() {
        let printed =
            "Done 7 in 3 s\nstat::number_of_executed_units: 1028719\nstat::average_exec_per_sec:     9\n";
        assert_eq!(executions(printed), Some(1_028_719));
        assert_eq!(executions("stat::average_exec_per_sec: 9"), None);
    }

    #[test]
    fn a_rate_is_that_of_the_processor_time() {
        assert_eq!(cpu_s("Done\n0m0.001s 0m0.002s\n1m9.500s 0m0.500s\n"), Some(70.0));
        assert_eq!(cpu_s("Done\n"), None);
        let effort = Effort { executions: 30_000_000, cpu_s: 20.0 };
        assert_eq!(effort.to_string(), "30000000 executions in 20.0 s of CPU, 1500000 a second");
    }
}
