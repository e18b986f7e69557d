//! The whole gate on two cores: which chores run at the same time.
//!
//! A build needs both cores, an emulated board one, the network none. Tests that measure time, and drives in processes of
//! their own with their timeouts, run when nothing else does.

use std::env;
use std::sync::OnceLock;
use std::thread;
use std::time::Instant;

use anyhow::Result;

use crate::command::command;
use crate::counts::Counts;
use crate::reports;

/// Chores that run one after the other.
pub(crate) type Lane = &'static [&'static str];

/// Installs what tests need: every chore but [`WITHOUT_EQUIPMENT`] starts after it.
const SETUP: &str = "setup";

/// Chores that need the compiler alone.
const WITHOUT_EQUIPMENT: [&str; 2] = [SETUP, "check"];

/// Needs no answer in time, and yields to the tests that do.
const IN_BACKGROUND: &str = "test python --timing untimed";

/// The lanes of a stage run at the same time, the stages one after the other. Each chore is a call of this program.
pub(crate) const STAGES: [&[Lane]; 2] = [
    &[&[SETUP, "test image"], &["check", "test unit --timing untimed", "test fuzz"]],
    &[&["test python --timing timed", "test loop", "test unit --timing timed"], &[IN_BACKGROUND]],
];

/// Runs the stages, and prints the reports of the tests.
///
/// # Errors
/// The folder of the reports can't be cleared or read.
pub(crate) fn run() -> Result<Counts> {
    reports::clear(&reports::folder())?;
    let (mut sum, started, set_up) = (Counts::default(), Instant::now(), OnceLock::new());
    for lanes in STAGES {
        thread::scope(|scope| {
            let lanes: Vec<_> =
                lanes.iter().map(|lane| scope.spawn(|| run_lane(lane, started, &set_up))).collect();
            for lane in lanes {
                sum += lane.join().unwrap_or(Counts { passed: 0, failed: 1 });
            }
        });
    }
    for line in reports::lines(&reports::folder())? {
        println!("{line}");
    }
    Ok(sum)
}

fn run_lane(chores: Lane, started: Instant, set_up: &OnceLock<()>) -> Counts {
    let mut sum = Counts::default();
    for &chore in chores {
        if !WITHOUT_EQUIPMENT.contains(&chore) {
            set_up.wait();
        }
        sum.step(chore, || run_chore(chore, started));
        if chore == SETUP {
            set_up.get_or_init(|| ());
        }
    }
    sum
}

/// Runs one chore and copies its lines, each with the time since the start and the chore's name.
fn run_chore(chore: &str, started: Instant) -> Result<Counts> {
    let print = |line: &str| {
        let seconds = started.elapsed().as_secs();
        println!("{:2}:{:02} {chore} | {line}", seconds / 60, seconds % 60);
    };
    let mut command = command("nice", if chore == IN_BACKGROUND { "-n 19" } else { "-n 0" });
    command.arg(env::current_exe()?).args(chore.split(' '));
    Counts::of_output(command, Counts::of_sum, print)
}
