//! The whole gate on two cores: which chores run at the same time.
//!
//! A build needs both cores, an emulated board one, the network none. Tests that measure time, and drives in processes of
//! their own with their timeouts, run when nothing else does.

use std::env;
use std::thread;
use std::time::Instant;

use anyhow::Result;

use crate::command::command;
use crate::counts::Counts;

/// Chores that run one after the other.
pub(crate) type Lane = &'static [&'static str];

/// The lanes of a stage run at the same time, the stages one after the other. Each chore is a call of this program.
pub(crate) const STAGES: [&[Lane]; 3] = [
    &[&["setup"], &["check"]],
    &[&["test image"], &["test unit --timing untimed", "test fuzz"]],
    &[&["test unit --timing timed", "test python", "test loop"]],
];

/// Runs the stages.
pub(crate) fn run() -> Counts {
    let (mut sum, started) = (Counts::default(), Instant::now());
    for lanes in STAGES {
        thread::scope(|scope| {
            let lanes: Vec<_> = lanes.iter().map(|lane| scope.spawn(|| run_lane(lane, started))).collect();
            for lane in lanes {
                sum += lane.join().unwrap_or(Counts { passed: 0, failed: 1 });
            }
        });
    }
    sum
}

fn run_lane(chores: Lane, started: Instant) -> Counts {
    let mut sum = Counts::default();
    for chore in chores {
        sum.step(chore, || run_chore(chore, started));
    }
    sum
}

/// Runs one chore and copies its lines, each with the time since the start and the chore's name.
fn run_chore(chore: &str, started: Instant) -> Result<Counts> {
    let print = |line: &str| {
        let seconds = started.elapsed().as_secs();
        println!("{:2}:{:02} {chore} | {line}", seconds / 60, seconds % 60);
    };
    Counts::of_output(command(env::current_exe()?, chore), Counts::of_sum, print)
}
