//! The rings of tests: from tests of pure functions to the image in the emulator.

use std::time::Duration;

use anyhow::Result;
use clap::{Args, ValueEnum};

use crate::arm_toolchain::{ArmToolchain, drives};
use crate::command::{cargo, run};
use crate::counts::Counts;
use crate::one_test::{Conditions, Test, run_each};
use crate::python::Project;
use crate::test_programs::{self, TestProgram};
use crate::{dist, fuzz, image, silicon, site, size};

#[derive(Args)]
pub(crate) struct Selection {
    /// The tests of one ring alone, without `setup`
    pub(crate) ring: Option<Ring>,
    /// Only the ring's tests that need a quiet machine, or all others
    #[arg(long, requires = "ring")]
    timing: Option<Timing>,
    /// Time for each fuzzer
    #[arg(long, requires = "ring", default_value_t = 20)]
    seconds: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Ring {
    /// Tests without the `lashloop` program, pseudo-terminals between processes, or emulator
    Unit,
    /// Tests like those of the unit ring, which take long: random plants, mutants of the drive, damaged frames by the million
    Long,
    /// The packages, and tests of the `lashloop` program and of drives on pseudo-terminals
    Loop,
    /// The Cortex-M image: build, size, clippy, and tests in the emulator
    Image,
    /// Runs of the bench at virtual silicon: the Cortex-M image on models of its chip
    Silicon,
    /// The Cortex-M image on the models of its chip, without the bench: pins, ticks, the time to the bridge off
    Chip,
    /// The Python package: lint, its own tests, and its drive on the bench; the documentation as a site
    Python,
    /// Reports and live pages in headless Chromium
    Browser,
    /// The bench in a Linux guest with the kernel's USB serial drivers
    Usb,
    /// Campaigns on a Slurm cluster of this machine
    Cluster,
    /// Every fuzzer for a bounded time
    Fuzz,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Timing {
    Timed,
    Untimed,
}

/// The ring of a test program. A new test program belongs to the unit ring.
fn ring_of(program: &str) -> Option<Ring> {
    match program {
        // A part of `cargo xtask check`.
        "tests tree" => None,
        "tests looped" | "tests conforming" | "tests flashed" | "tests network" | "tests rigs"
        | "host/cli tools" => Some(Ring::Loop),
        "host/hardware identified"
        | "host/identify identify"
        | "tests mutants"
        | "tests reference"
        | "tests robustness" => Some(Ring::Long),
        "tests emulated" => Some(Ring::Image),
        test_programs::USB => Some(Ring::Usb),
        test_programs::CLUSTER => Some(Ring::Cluster),
        "tests silicon" => Some(Ring::Silicon),
        PYTHON => Some(Ring::Python),
        _ => Some(Ring::Unit),
    }
}

/// The module of tests that measure wall-clock time, which run one at a time on a machine as quiet as we can make it.
const WALL_CLOCK: (&str, &str) = ("tests looped", "wall_clock::");

/// The test program of the ring [`Ring::Python`]: drives in Python, which need a quiet machine.
const PYTHON: &str = "tests python";

impl Ring {
    /// How the tests of the ring run. The limit is several times what the slowest takes with both cores busy.
    fn conditions(self) -> Conditions {
        let conditions = |at_once, minutes: u64, has_second_attempt| Conditions {
            at_once,
            limit: Duration::from_secs(60 * minutes),
            has_second_attempt,
        };
        match self {
            // Drives run in one process with these tests.
            Self::Unit | Self::Long => conditions(2, 5, false),
            // A test and its drive take turns: with more of them, answers wait for cores until they count as lost.
            Self::Loop => conditions(2, 10, true),
            // One after the other: bench and drive take turns on the cores.
            Self::Python => conditions(1, 10, true),
            _ => conditions(2, 10, true),
        }
    }
}

impl Selection {
    pub(crate) fn run(&self, ring: Ring) -> Counts {
        let mut counts = Counts::default();
        match ring {
            Ring::Unit => {
                counts.step("documentation examples", documentation);
            }
            Ring::Image => {
                counts.step("image", image::build);
                counts.step("image size", size::check);
                counts.step("image clippy", || {
                    let toolchain = ArmToolchain::find()?;
                    drives()?.iter().try_for_each(|program| run(&mut toolchain.clippy(program)?))
                });
            }
            Ring::Python if self.timing != Some(Timing::Timed) => {
                counts.step("python lint", || Project::Package.lint());
                counts.step("documentation site", site::make);
                counts.step("python package", || Project::Package.test());
                if self.timing == Some(Timing::Untimed) {
                    return counts;
                }
            }
            Ring::Silicon => {
                // The longest build is first: by its end another ring has built the image.
                counts.step("virtual silicon", silicon::build);
                counts.step("image", image::build);
                counts.step("image of the probe", silicon::build_probe);
            }
            Ring::Chip => {
                counts.step("image", image::build);
                counts.step("image of the probe", silicon::build_probe);
                counts.step("virtual silicon, its own tests", || {
                    let programs = silicon::test_programs()?;
                    Ok(run_each(&tests_of(&programs)?, ring.conditions()))
                });
                return counts;
            }
            Ring::Browser => {
                counts.step("browser lint", || Project::BrowserTests.lint());
                counts.step("browser", || Project::BrowserTests.test());
                return counts;
            }
            Ring::Fuzz => {
                counts.step("fuzz", || fuzz::run_all(self.seconds));
                return counts;
            }
            Ring::Loop if self.timing != Some(Timing::Timed) => {
                counts.step("packages", || dist::make(dist::Profile::Dev));
            }
            Ring::Long | Ring::Loop | Ring::Python | Ring::Usb | Ring::Cluster => {}
        }
        let mut programs = Vec::new();
        counts.step("test programs", || {
            programs = test_programs::build()?;
            Ok(Counts::default())
        });
        programs.retain(|program| ring_of(&program.name) == Some(ring));
        let (whole, programs): (Vec<_>, Vec<_>) =
            programs.iter().partition(|it| [test_programs::USB, test_programs::CLUSTER].contains(&&*it.name));
        for program in whole {
            counts.step(&program.name, || program.run_whole());
        }
        counts.step("tests", || {
            let (wall_clock, others): (Vec<_>, Vec<_>) = tests_of(programs)?.into_iter().partition(|it| {
                (it.program.name.as_str(), it.name.starts_with(WALL_CLOCK.1)) == (WALL_CLOCK.0, true)
            });
            let mut counts = Counts::default();
            if self.timing != Some(Timing::Timed) || ring == Ring::Python {
                counts += run_each(&others, ring.conditions());
            }
            if self.timing != Some(Timing::Untimed) {
                let alone = Conditions { at_once: 1, has_second_attempt: false, ..ring.conditions() };
                counts += run_each(&wall_clock, alone);
            }
            Ok(counts)
        });
        counts
    }
}

fn tests_of<'a>(programs: impl IntoIterator<Item = &'a TestProgram>) -> Result<Vec<Test<'a>>> {
    let mut tests = Vec::new();
    for program in programs {
        tests.extend(program.tests()?.into_iter().map(|name| Test { program, name }));
    }
    Ok(tests)
}

/// The examples in doc comments.
fn documentation() -> Result<Counts> {
    let tests = cargo("test --workspace --doc --no-fail-fast");
    Counts::of_output(tests, Counts::of_libtest, |line| println!("{line}"))
}
