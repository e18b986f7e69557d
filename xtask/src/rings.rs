//! The rings of tests: from tests of pure functions to the image in the emulator.

use anyhow::Result;
use clap::{Args, ValueEnum};

use crate::arm_toolchain::{ArmToolchain, DRIVE, DRIVE_ON_ODRIVE};
use crate::command::{cargo, run};
use crate::counts::Counts;
use crate::python::Project;
use crate::test_programs::{self, TestProgram};
use crate::{dist, fuzz, image, silicon, size};

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
    /// Tests of the `lashloop` program and of drives on pseudo-terminals
    Loop,
    /// The Cortex-M image: build, size, clippy, and tests in the emulator
    Image,
    /// Runs of the bench at virtual silicon: the Cortex-M image on models of its chip
    Silicon,
    /// The Cortex-M image on the models of its chip, without the bench: pins, ticks, the time to the bridge off
    Chip,
    /// The Python package: lint, its own tests, and its drive on the bench
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
        | "host tools" => Some(Ring::Loop),
        "tests emulated" => Some(Ring::Image),
        test_programs::USB => Some(Ring::Usb),
        test_programs::CLUSTER => Some(Ring::Cluster),
        "tests silicon" => Some(Ring::Silicon),
        PYTHON => Some(Ring::Python),
        _ => Some(Ring::Unit),
    }
}

/// Modules of a test program whose tests run in real time or measure time: they need a quiet machine.
fn timed_modules(program: &str) -> &'static [&'static str] {
    match program {
        "host/bench lashloop_bench" => &["real_time::"],
        "host/link lashloop_link" => &["uart_model::"],
        "tests looped" => &[
            "budget::",
            "capture::a_bench_killed_in_real_time",
            "capture::a_real_time",
            "compared::",
            "fault_table::every_row_of_the_table_holds_on_the_native_twin",
            "idle::",
            "real_time::",
            "reconnect::",
            "speed::",
            "wire::",
        ],
        _ => &[],
    }
}

/// A test program, and its module whose tests mostly wait: they run at the same time as its other untimed tests.
const WAITING: (&str, &str) = ("tests looped", "soak::");

/// The test program of the ring [`Ring::Python`]: drives in Python, which need a quiet machine.
const PYTHON: &str = "tests python";

/// Arguments of a test program that leave these modules out.
fn without(modules: &[&str]) -> String {
    modules.iter().map(|module| format!(" --skip {module}")).collect()
}

/// Runs the tests of a program but those of `timed` modules.
fn run_untimed(program: &TestProgram, timed: &[&str]) -> Result<Counts> {
    if program.name != WAITING.0 {
        return program.run_on_shared_machine(&without(timed));
    }
    // More threads than cores: tests of drives in other processes mostly wait for them.
    let others = format!("--test-threads 3 --skip {}{}", WAITING.1, without(timed));
    Ok(Counts::of_each(&[WAITING.1, &others], 2, |arguments| {
        let counts = program.run_on_shared_machine(arguments);
        counts.unwrap_or_else(|error| Counts::failed(&program.name, &error))
    }))
}

impl Selection {
    pub(crate) fn run(&self, ring: Ring) -> Counts {
        let mut counts = Counts::default();
        match ring {
            Ring::Unit if self.timing != Some(Timing::Timed) => {
                counts.step("documentation examples", documentation);
            }
            Ring::Image => {
                counts.step("image", image::build);
                counts.step("image size", size::check);
                for program in [DRIVE, DRIVE_ON_ODRIVE] {
                    counts.step("image clippy", || run(&mut ArmToolchain::find()?.clippy(&program)?));
                }
            }
            Ring::Python if self.timing != Some(Timing::Timed) => {
                counts.step("python lint", || Project::Package.lint());
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
                counts.step("virtual silicon, its own tests", silicon::test);
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
                counts.step("static program", || dist::make(dist::Profile::Dev));
            }
            Ring::Unit | Ring::Loop | Ring::Python | Ring::Usb | Ring::Cluster => {}
        }
        let mut programs = Vec::new();
        counts.step("test programs", || {
            programs = test_programs::build()?;
            Ok(Counts::default())
        });
        programs.retain(|program| ring_of(&program.name) == Some(ring));
        if ring == Ring::Unit && self.timing != Some(Timing::Timed) {
            // Drives run in one process with these tests. The last test of a program occupies one core; in the whole command other chores have the other.
            let at_once = if self.timing.is_none() { 2 } else { 1 };
            counts.step("programs", || {
                let run = |it: &TestProgram| it.run(&without(timed_modules(&it.name)));
                Ok(Counts::of_each(&programs, at_once, run))
            });
        }
        for program in &programs {
            if program.name == PYTHON {
                // One after the other: bench and drive take turns on the cores.
                counts.step(PYTHON, || program.run_on_shared_machine("--test-threads 1"));
                continue;
            }
            let timed = timed_modules(&program.name);
            if ring != Ring::Unit && self.timing != Some(Timing::Timed) {
                counts.step(&program.name, || run_untimed(program, timed));
            }
            if self.timing != Some(Timing::Untimed) && !timed.is_empty() {
                counts.step(&format!("{}, timed", program.name), || {
                    program.run_on_shared_machine(&timed.join(" "))
                });
            }
        }
        counts
    }
}

/// The examples in doc comments.
fn documentation() -> Result<Counts> {
    let tests = cargo("test --workspace --doc --no-fail-fast");
    Counts::of_output(tests, Counts::of_libtest, |line| println!("{line}"))
}
