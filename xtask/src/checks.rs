//! Every check of the project in one go.
//!
//! A step that fails doesn't keep the others from running: one call shows everything that is wrong.

use std::io::{self, BufReader};
use std::process::{Command, ExitCode, Stdio};

use anyhow::{Context, Result};

use crate::arm_toolchain::ArmToolchain;
use crate::test_counts::Counts;
use crate::{command, fuzz, image, python, setup, size};

/// Runs all checks. The last line printed is the sum, in which every test and every other step counts one.
pub(crate) fn run_all() -> ExitCode {
    let mut checks = Checks::default();
    checks.step("setup", setup::install_missing);
    checks.step("format", || command::run(cargo("fmt").args(["--all", "--check"])));
    checks.step("clippy", || command::run(cargo("clippy").args(ALL_TARGETS).args(["--", "-D", "warnings"])));
    checks.step("documentation", || {
        command::run(cargo("doc").args(["--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
    });
    checks.step("image", image::build);
    checks.step("image size", size::check);
    match ArmToolchain::find().map(|toolchain| toolchain.clippy()) {
        Ok(Some(mut clippy)) => checks.step("image clippy", || command::run(&mut clippy)),
        Ok(None) => {
            println!("== image clippy left out: no clippy for this compiler (rust-web-clippy on Debian)");
        }
        // The step that builds the image has said why.
        Err(_) => {}
    }
    checks.step("python", python::lint);
    checks.counted("tests", run_tests);
    checks.counted("python tests", python::test);
    checks.step("fuzz", || fuzz::run(FUZZ_SECONDS));
    let Counts { passed, failed } = checks.0;
    println!("{passed} passed, {failed} failed");
    if failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// For each fuzzer: enough to try the seeds and a few hundred thousand inputs more.
const FUZZ_SECONDS: u32 = 20;

const ALL_TARGETS: [&str; 2] = ["--workspace", "--all-targets"];

#[derive(Default)]
struct Checks(Counts);

impl Checks {
    fn step(&mut self, name: &str, run: impl FnOnce() -> Result<()>) {
        println!("== {name}");
        match run() {
            Ok(()) => self.0.passed += 1,
            Err(error) => self.fail(name, &error),
        }
    }

    fn counted(&mut self, name: &str, run: impl FnOnce() -> Result<Counts>) {
        println!("== {name}");
        match run() {
            Ok(counts) => self.0 += counts,
            Err(error) => self.fail(name, &error),
        }
    }

    fn fail(&mut self, name: &str, error: &anyhow::Error) {
        println!("{name} failed: {error:#}");
        self.0.failed += 1;
    }
}

fn cargo(chore: &str) -> Command {
    let mut command = command::cargo();
    command.arg(chore);
    command
}

fn run_tests() -> Result<Counts> {
    let mut tests = cargo("test");
    tests.args(["--workspace", "--release", "--no-fail-fast"]).stdin(Stdio::null()).stdout(Stdio::piped());
    // Tests that need the image or the emulator fail where these are missing, instead of being left out.
    tests.env("LASHLOOP_LEAVE_NOTHING_OUT", "1");
    let mut child = tests.spawn().with_context(|| command::cannot_start(&tests))?;
    let stdout = child.stdout.take().context("the output of the tests was not kept")?;
    let counts = Counts::of_stream(BufReader::new(stdout), io::stdout())?;
    let status = child.wait()?;
    // A test that doesn't build or dies of a signal has no line of its own in the counts.
    if !status.success() && counts.failed == 0 {
        println!("{} ended with {status}", command::name(&tests));
        return Ok(Counts { failed: 1, ..counts });
    }
    Ok(counts)
}
