//! The rings of tests: from tests of pure functions to the image in the emulator.

use std::process::ExitCode;

use clap::{Subcommand, ValueEnum};

use crate::arm_toolchain::ArmToolchain;
use crate::tally::Tally;
use crate::test_programs::{self, TestProgram};
use crate::{command, fuzz, image, python, size};

#[derive(Subcommand)]
pub(crate) enum Ring {
    /// Tests without child processes, pseudo-terminals or emulator
    Unit,
    /// Tests of the `lashloop` program and of drives on pseudo-terminals
    Loop {
        /// Only tests that measure time, or all others
        #[arg(long)]
        timing: Option<Timing>,
    },
    /// The Cortex-M image: build, size, clippy, and tests in the emulator
    Image,
    /// The Python package: lint, its own tests, and its drive on the bench
    Python,
    /// Every fuzzer for a bounded time
    Fuzz {
        /// Time for each fuzzer
        #[arg(long, default_value_t = 20)]
        seconds: u32,
    },
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Timing {
    Timed,
    Untimed,
}

/// Modules of `looped` that measure wall-clock or processor time.
const TIMED: [&str; 6] = ["budget::", "compared::", "idle::", "real_time::", "speed::", "wire::"];

/// The runs of a test program in this ring, each with its arguments. A new program belongs to the unit ring.
fn runs(ring: &Ring, program: &TestProgram) -> Vec<Vec<&'static str>> {
    let is_listed = match (program.package.as_str(), program.target.as_str()) {
        ("tests", "looped") => return runs_of_looped(ring),
        ("tests", "conforming") | ("lashloop", "tools") => {
            matches!(ring, Ring::Loop { timing: None | Some(Timing::Untimed) })
        }
        ("tests", "emulated") => matches!(ring, Ring::Image),
        ("tests", "python") => matches!(ring, Ring::Python),
        _ => matches!(ring, Ring::Unit),
    };
    if is_listed { vec![Vec::new()] } else { Vec::new() }
}

fn runs_of_looped(ring: &Ring) -> Vec<Vec<&'static str>> {
    let timed = TIMED.to_vec();
    let untimed = TIMED.map(|module| ["--skip", module]).concat();
    match ring {
        Ring::Loop { timing: None } => vec![untimed, timed],
        Ring::Loop { timing: Some(Timing::Timed) } => vec![timed],
        Ring::Loop { timing: Some(Timing::Untimed) } => vec![untimed],
        Ring::Unit | Ring::Image | Ring::Python | Ring::Fuzz { .. } => Vec::new(),
    }
}

/// Runs one ring. The last line printed is the sum.
pub(crate) fn run(ring: &Ring) -> ExitCode {
    let mut tally = Tally::default();
    match ring {
        Ring::Unit => {
            run_programs(ring, &mut tally);
            tally.counted("documentation examples", test_programs::documentation);
        }
        Ring::Loop { .. } => run_programs(ring, &mut tally),
        Ring::Image => {
            tally.step("image", image::build);
            tally.step("image size", size::check);
            tally.step("image clippy", || command::run(&mut ArmToolchain::find()?.clippy()?));
            run_programs(ring, &mut tally);
        }
        Ring::Python => {
            tally.step("python lint", python::lint);
            run_programs(ring, &mut tally);
            tally.counted("python tests", python::test);
        }
        Ring::Fuzz { seconds } => tally.counted("fuzz", || fuzz::run(*seconds)),
    }
    tally.finish()
}

fn run_programs(ring: &Ring, tally: &mut Tally) {
    let programs = match test_programs::build() {
        Ok(programs) => programs,
        Err(error) => return tally.step("test programs", || Err(error)),
    };
    for program in &programs {
        for arguments in runs(ring, program) {
            let name = [&program.package, &program.target].map(String::as_str).join(" ");
            tally.counted(&name, || program.run(&arguments));
        }
    }
}
