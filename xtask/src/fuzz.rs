//! A bounded run of every fuzzer in `fuzz/`.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};

use crate::command;

const TARGETS: [&str; 3] = ["decoder", "drive", "scenario"];
const CARGO_FUZZ_VERSION: &str = "0.13.2";

/// Gives every fuzzer `seconds` to find an input that breaks a promise.
///
/// What it learns stays in `target/fuzz`, so that the next run goes on from there and the committed seeds stay as
/// they are.
///
/// # Errors
/// What is missing and how to get it, or which fuzzer found something and where it lies.
pub(crate) fn run(seconds: u32) -> Result<()> {
    let program = cargo_fuzz()?;
    command::run(fuzz(&program, "build"))?;
    for target in TARGETS {
        let learnt = crate::root().join("target/fuzz/corpus").join(target);
        std::fs::create_dir_all(&learnt).with_context(|| format!("{} cannot be made", learnt.display()))?;
        let seeds = crate::root().join("fuzz/corpus").join(target);
        println!("== fuzz {target} for {seconds} s");
        let limits = [format!("-max_total_time={seconds}"), "-timeout=10".into(), "-verbosity=0".into()];
        command::run(fuzz(&program, "run").arg(target).args([learnt, seeds]).arg("--").args(limits))
            .with_context(|| format!("the fuzzer `{target}` found an input, kept in fuzz/artifacts/{target}"))?;
    }
    Ok(())
}
