//! The whole test command on two cores: which chores run at the same time.
//!
//! A build needs both cores, an emulated board one, the network none, and builds of one target folder wait for each other:
//! three lanes keep both cores busy, and no more than two of them build. Tests that measure time come last. They leave most of
//! the cores to chores in the background, which the scheduler interrupts at once for anything else.

use std::env;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::command::command;
use crate::counts::Counts;
use crate::log::{self, Log};
use crate::reports;

/// Chores that run one after the other.
pub(crate) type Lane = &'static [&'static str];

/// Installs what tests need: every chore but [`WITHOUT_EQUIPMENT`] starts after it.
const SETUP: &str = "setup";

/// Chores that need the compiler alone.
const WITHOUT_EQUIPMENT: [&str; 2] = [SETUP, "check"];

/// Need no answer in time, and yield to the tests that do.
const IN_BACKGROUND: [&str; 2] = ["test python --timing untimed", "test chip"];

/// The lanes of a stage run at the same time, the stages one after the other. Each chore is a call of this program.
pub(crate) const STAGES: [&[Lane]; 2] = [
    &[
        &[SETUP, "test image", "test usb", "test cluster", "test browser"],
        &["check", "test silicon"],
        &["test unit --timing untimed", "test fuzz --seconds 10", "test loop --timing untimed"],
    ],
    &[
        &["test python --timing timed", "test loop --timing timed", "test unit --timing timed"],
        &[IN_BACKGROUND[0]],
        &[IN_BACKGROUND[1]],
    ],
];

/// Runs the stages, and prints the reports of the tests, the time of each chore, and the names of what failed.
///
/// # Errors
/// The folder of the reports or of the logs can't be cleared or read.
pub(crate) fn run() -> Result<Counts> {
    reports::clear(&reports::folder())?;
    reports::clear(&log::folder())?;
    let mut sum = Counts::default();
    let whole = Whole { started: Instant::now(), set_up: OnceLock::new(), recap: Mutex::default() };
    for lanes in STAGES {
        thread::scope(|scope| {
            let lanes: Vec<_> = lanes.iter().map(|lane| scope.spawn(|| whole.run_lane(lane))).collect();
            for lane in lanes {
                sum += lane.join().unwrap_or(Counts::FAILED);
            }
        });
    }
    for line in reports::lines(&reports::folder())? {
        println!("{line}");
    }
    for line in whole.recap.into_inner().unwrap_or_else(PoisonError::into_inner) {
        println!("{line}");
    }
    Ok(sum)
}

/// One run of the whole test command.
struct Whole {
    started: Instant,
    set_up: OnceLock<()>,
    /// Lines to repeat at the end.
    recap: Mutex<Vec<String>>,
}

impl Whole {
    fn run_lane(&self, chores: Lane) -> Counts {
        let mut sum = Counts::default();
        for &chore in chores {
            if !WITHOUT_EQUIPMENT.contains(&chore) {
                self.set_up.wait();
            }
            println!("== {chore}");
            sum += self.run_chore(chore).unwrap_or_else(|error| {
                println!("{chore} failed: {error:#}");
                Counts::FAILED
            });
            if chore == SETUP {
                self.set_up.get_or_init(|| ());
            }
        }
        sum
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
        let program = env::current_exe()?;
        let mut command = if IN_BACKGROUND.contains(&chore) {
            let mut command = command("chrt", "--idle 0");
            command.arg(program);
            command
        } else {
            command(program, "")
        };
        command.args(chore.split(' '));
        let counts = Counts::of_output(command, Counts::of_sum, print);
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
