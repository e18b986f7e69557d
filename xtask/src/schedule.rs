//! The whole test command on two cores: which chores run at the same time.
//!
//! A build needs both cores, an emulated board one, the network none, and builds of one target folder wait for each other:
//! two chores at a time and one that waits keep both cores busy. Tests that measure time come last, when little else runs.

use std::env;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::command::command;
use crate::counts::Counts;
use crate::log::{self, Log};
use crate::reports;

/// Chores that start in their order, some of them at once.
pub(crate) struct Queue {
    at_once: usize,
    pub(crate) chores: &'static [&'static str],
}

/// Installs what tests need: every chore but [`WITHOUT_EQUIPMENT`] starts after it.
const SETUP: &str = "setup";

/// Chores that need the compiler alone.
const WITHOUT_EQUIPMENT: [&str; 2] = [SETUP, "check"];

/// Needs no answer in time, computes on one core, and yields to the tests that measure time. Chores that occupy both cores
/// delay these tests by up to 100 ms even at the lowest priority.
const IN_BACKGROUND: &str = "test python --timing untimed";

/// Need no answer in time: they yield to emulators and to drives in other processes, whose clocks lag behind on a busy machine.
/// So does every compiler.
const COMPUTING: [&str; 5] = ["check", "test unit", "test long", FUZZ, "test chip"];
/// Cargo starts compilers by the program that this variable names.
const COMPILER_WRAPPER: &str = "RUSTC_WRAPPER";

const FUZZ: &str = "test fuzz --seconds 10";

/// Tests named at the end.
const SLOWEST: usize = 10;

/// The queues of a stage run at the same time, the stages one after the other. Each chore is a call of this program.
pub(crate) const STAGES: [&[Queue]; 2] = [
    &[
        Queue {
            at_once: 2,
            chores: &[
                "check",
                SETUP,
                "test unit",
                "test silicon",
                "test long",
                FUZZ,
                "test loop --timing untimed",
                "test chip",
                "test browser",
            ],
        },
        // Mostly wait for emulators, whose clocks lag behind on a busier machine.
        Queue { at_once: 1, chores: &["test image", "test usb", "test cluster"] },
    ],
    &[
        Queue { at_once: 1, chores: &["test python --timing timed", "test loop --timing timed"] },
        Queue { at_once: 1, chores: &[IN_BACKGROUND] },
    ],
];

/// Runs the stages, and prints the reports of the tests, the time of each chore, the names of what failed and of the slowest tests.
///
/// # Errors
/// The folder of the reports or of the logs can't be cleared or read.
pub(crate) fn run() -> Result<Counts> {
    reports::clear(&reports::folder())?;
    reports::clear(&log::folder())?;
    let mut sum = Counts::default();
    let whole = Whole {
        started: Instant::now(),
        set_up: OnceLock::new(),
        recap: Mutex::default(),
        durations: Mutex::default(),
    };
    for queues in STAGES {
        sum += Counts::of_each(queues, queues.len(), |queue, _| {
            Counts::of_each(queue.chores, queue.at_once, |chore, _| whole.run_in_turn(chore))
        });
    }
    for line in reports::lines(&reports::folder())? {
        println!("{line}");
    }
    for line in whole.recap.into_inner().unwrap_or_else(PoisonError::into_inner) {
        println!("{line}");
    }
    let mut durations = whole.durations.into_inner().unwrap_or_else(PoisonError::into_inner);
    durations.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    println!("the slowest tests:");
    for (seconds, name) in durations.iter().take(SLOWEST) {
        println!("{seconds:8.1} s  {name}");
    }
    println!("tests of wall-clock time without a verdict: {}", sum.not_judged);
    Ok(sum)
}

/// One run of the whole test command.
struct Whole {
    started: Instant,
    set_up: OnceLock<()>,
    /// Lines to repeat at the end.
    recap: Mutex<Vec<String>>,
    /// Time in seconds and name of each test.
    durations: Mutex<Vec<(f64, String)>>,
}

impl Whole {
    /// Runs a chore once its equipment is set up.
    fn run_in_turn(&self, chore: &str) -> Counts {
        if !WITHOUT_EQUIPMENT.contains(&chore) {
            self.set_up.wait();
        }
        println!("== {chore}");
        let counts = self.run_chore(chore).unwrap_or_else(|error| Counts::failed(chore, &error));
        if chore == SETUP {
            self.set_up.get_or_init(|| ());
        }
        counts
    }

    /// Runs one chore. Its output goes to its log; what isn't mere progress is also printed, with the time since the start
    /// and the chore's name.
    fn run_chore(&self, chore: &str) -> Result<Counts> {
        let started = Instant::now();
        let log = Log::create(chore)?;
        let print = |line: &str| {
            log.write(line);
            if !log::is_progress(line) {
                println!("{} {chore} | {line}", minutes(self.started.elapsed()));
            }
        };
        let niceness = match chore {
            IN_BACKGROUND => 19,
            _ if COMPUTING.contains(&chore) => 10,
            _ => 0,
        };
        let mut command = command("nice", &format!("-n {niceness}"));
        command.arg(env::current_exe()?).args(chore.split(' '));
        if env::var_os(COMPILER_WRAPPER).is_none() {
            command.env(COMPILER_WRAPPER, "nice");
        }
        let counts = Counts::of_output(command, Counts::of_sum, print);
        self.durations.lock().unwrap_or_else(PoisonError::into_inner).extend(log.durations());
        let mut recap = self.recap.lock().unwrap_or_else(PoisonError::into_inner);
        let result = counts.as_ref().map_or_else(|error| format!("{error:#}"), Counts::to_string);
        let cpu_time = log.cpu_time().map_or_else(String::new, |time| format!(" ({time})"));
        recap.push(format!("{} {chore}: {result}{cpu_time}", minutes(started.elapsed())));
        recap.extend(log.failures().into_iter().map(|line| format!("      {line}")));
        counts
    }
}

fn minutes(time: Duration) -> String {
    format!("{:2}:{:02}", time.as_secs() / 60, time.as_secs() % 60)
}
