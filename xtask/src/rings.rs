//! The rings of tests: from tests of pure functions to the image in the emulator.

use std::process::ExitCode;

use clap::{Args, Subcommand, ValueEnum};

use crate::arm_toolchain::ArmToolchain;
use crate::tally::Tally;
use crate::test_programs::{self, TestProgram};
use crate::{command, fuzz, image, python, size};

#[derive(Subcommand, PartialEq, Eq)]
pub(crate) enum Ring {
    /// Tests without the `lashloop` program, pseudo-terminals between processes, or emulator
    Unit {
        #[command(flatten)]
        part: Part,
    },
    /// Tests of the `lashloop` program and of drives on pseudo-terminals
    Loop {
        #[command(flatten)]
        part: Part,
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

#[derive(Args, PartialEq, Eq)]
pub(crate) struct Part {
    /// Only tests that need a quiet machine, or all others
    #[arg(long)]
    timing: Option<Timing>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Timing {
    Timed,
    Untimed,
}

/// Modules, by package and target, whose tests run in real time or measure time: they need a quiet machine.
const TIMED: [(&str, &str, &[&str]); 2] = [
    ("lashloop-bench", "lashloop_bench", &["real_time::"]),
    ("tests", "looped", &["budget::", "compared::", "idle::", "real_time::", "speed::", "wire::"]),
];

impl Ring {
    /// A new test program belongs to the unit ring.
    fn has(&self, program: &TestProgram) -> bool {
        match (program.package.as_str(), program.target.as_str()) {
            ("tests", "looped" | "conforming") | ("lashloop", "tools") => matches!(self, Self::Loop { .. }),
            ("tests", "emulated") => *self == Self::Image,
            ("tests", "python") => *self == Self::Python,
            _ => matches!(self, Self::Unit { .. }),
        }
    }

    fn timing(&self) -> Option<Timing> {
        match self {
            Self::Unit { part } | Self::Loop { part } => part.timing,
            Self::Image | Self::Python | Self::Fuzz { .. } => None,
        }
    }

    /// The runs of a test program in this ring, each with its arguments.
    fn runs_of(&self, program: &TestProgram) -> Vec<Vec<&'static str>> {
        if !self.has(program) {
            return Vec::new();
        }
        let is_program =
            |entry: &&(&str, &str, _)| (entry.0, entry.1) == (&*program.package, &*program.target);
        let timed = TIMED.iter().find(is_program).map(|(_, _, modules)| modules.to_vec());
        let untimed = timed.iter().flatten().flat_map(|module| ["--skip", module]).collect();
        match self.timing() {
            None => [untimed].into_iter().chain(timed).collect(),
            Some(Timing::Untimed) => vec![untimed],
            Some(Timing::Timed) => timed.into_iter().collect(),
        }
    }
}

/// Runs one ring. The last line printed is the sum.
pub(crate) fn run(ring: &Ring) -> ExitCode {
    let mut tally = Tally::default();
    match ring {
        Ring::Unit { part } => {
            run_programs(ring, &mut tally);
            if part.timing != Some(Timing::Timed) {
                tally.counted("documentation examples", test_programs::documentation);
            }
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
        for arguments in ring.runs_of(program) {
            let name = [&program.package, &program.target].map(String::as_str).join(" ");
            tally.counted(&name, || program.run(&arguments));
        }
    }
}
