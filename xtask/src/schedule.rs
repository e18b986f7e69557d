//! The whole gate on two cores: which chores run at the same time.
//!
//! A build needs both cores, an emulated board one, the network none. Tests that measure time run when nothing else does.

use std::env;
use std::io::{self, BufRead, BufReader};
use std::process::{Command, ExitCode, Stdio};
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result};

use crate::tally::Tally;
use crate::test_counts::Counts;

/// Chores that run one after the other.
pub(crate) type Lane = &'static [&'static str];

/// The lanes of a stage run at the same time, the stages one after the other. Each chore is a call of this program.
pub(crate) const STAGES: [&[Lane]; 3] = [
    &[&["setup"], &["check"]],
    &[
        &["test image", "test fuzz"],
        &["test unit --timing untimed", "test loop --timing untimed", "test python"],
    ],
    &[&["test unit --timing timed", "test loop --timing timed"]],
];

/// Runs the stages. The last line printed is the sum.
pub(crate) fn run() -> ExitCode {
    let (mut tally, started) = (Tally::default(), Instant::now());
    for lanes in STAGES {
        let counts = thread::scope(|scope| {
            let lanes: Vec<_> = lanes.iter().map(|lane| scope.spawn(|| run_lane(lane, started))).collect();
            lanes.into_iter().map(|lane| lane.join().unwrap_or(FAILURE)).collect::<Vec<_>>()
        });
        counts.into_iter().for_each(|counts| tally.add(counts));
    }
    tally.finish()
}

const FAILURE: Counts = Counts { passed: 0, failed: 1 };

fn run_lane(chores: Lane, started: Instant) -> Counts {
    let mut sum = Counts::default();
    for chore in chores {
        sum += run_chore(chore, started).unwrap_or_else(|error| {
            println!("{chore} failed: {error:#}");
            FAILURE
        });
    }
    sum
}

/// Runs one chore and copies its lines, each with the time since the start and the chore's name.
fn run_chore(chore: &str, started: Instant) -> Result<Counts> {
    let (reader, writer) = io::pipe()?;
    let mut command = Command::new(env::current_exe()?);
    command.args(chore.split(' ')).stdin(Stdio::null()).stdout(writer.try_clone()?).stderr(writer);
    let mut child = command.spawn().with_context(|| format!("{chore} can't be started"))?;
    // The command holds the writing end, which would keep the pipe open.
    drop(command);
    let mut sum = None;
    for line in BufReader::new(reader).split(b'\n') {
        let line = line?;
        let line = String::from_utf8_lossy(&line);
        let seconds = started.elapsed().as_secs();
        println!("{:2}:{:02} {chore} | {line}", seconds / 60, seconds % 60);
        sum = Counts::of_sum(&line).or(sum);
    }
    let status = child.wait()?;
    Ok(match sum {
        Some(counts) if status.success() || counts.failed > 0 => counts,
        None if status.success() => Counts { passed: 1, failed: 0 },
        Some(Counts { passed, .. }) => Counts { passed, failed: 1 },
        None => FAILURE,
    })
}
