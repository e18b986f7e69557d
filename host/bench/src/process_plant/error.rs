//! What a process can do wrong.

use std::io;
use std::path::PathBuf;
use std::time::Duration;

use lashloop_plant::PlantError;

/// Why a plant in another process failed. Each message says what to do.
#[derive(Debug, thiserror::Error)]
pub enum ProcessError {
    /// The command can't be started.
    #[error("the plant can't be started: {reason}; correct plant.command")]
    Start {
        /// What is wrong with the command.
        reason: String,
    },
    /// The bench can't start processes.
    #[error("the plant can't be started: {0}")]
    System(#[from] io::Error),
    /// The process ended, or closed its standard output.
    #[error("the plant's process ended in the middle of the run{status}{stderr}")]
    Ended {
        /// `: exit status 1`, if it is known.
        status: String,
        /// `; it wrote "..."`, if it wrote anything to standard error.
        stderr: String,
    },
    /// The process did not write a line in time.
    #[error(
        "the plant's process wrote no line within {} ms; it must write one for each line that it reads, and flush it, \
         or set plant.{key}{stderr}",
        limit.as_millis()
    )]
    Silent {
        /// The limit.
        limit: Duration,
        /// Its key.
        key: &'static str,
        /// As in `Ended`.
        stderr: String,
    },
    /// The process did not read its line in time.
    #[error(
        "the plant's process did not read its line within {} ms; it must read one line for each line that it writes, or \
         set plant.{key}{stderr}",
        limit.as_millis()
    )]
    NotRead {
        /// The limit.
        limit: Duration,
        /// Its key.
        key: &'static str,
        /// As in `Ended`.
        stderr: String,
    },
    /// More lines than the bench has sent.
    #[error(
        "the plant's process wrote {line:?} without a step for it; it must write one line for each line that it reads"
    )]
    Unrequested {
        /// The line; its beginning, if it is long.
        line: String,
    },
    /// A line that is not of the protocol.
    #[error(
        "the plant's process wrote {line:?}: {reason}; standard output is for the protocol alone, other text goes to \
         standard error"
    )]
    Malformed {
        /// The line; its beginning, if it is long.
        line: String,
        /// What the parser expected.
        reason: String,
    },
    /// Another version of the protocol.
    #[error(
        "the plant's process has version {have} of the protocol, the bench has {want}; change the program"
    )]
    Version {
        /// The process's.
        have: u32,
        /// The bench's.
        want: u32,
    },
    /// A file of `plant.files` can't be read.
    #[error("plant.files: {}: {source}; a relative path starts at the folder of the plant", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The program that loads FMUs is missing.
    #[error(
        "no program lashloop-fmu next to {} or in PATH, which FMUs need; `cargo build --release -p lashloop-fmu` makes \
         it, or plant.command names another", bench.display()
    )]
    NoLoader {
        /// This program.
        bench: PathBuf,
    },
    /// An FMU takes no velocities from the bench.
    #[error(
        "plant.initial has a velocity, and an FMU starts as plant.start says; give the velocity there, and omit it in \
         plant.initial"
    )]
    InitialVelocity,
    /// The process doesn't start where the scenario says.
    #[error(
        "the plant's process starts with {key} = {have}, and plant.initial.{key} is {want}; a process that can't start \
         there needs its own position in [plant.initial]"
    )]
    OtherStart {
        /// The position.
        key: &'static str,
        /// The process's.
        have: f64,
        /// The scenario's.
        want: f64,
    },
    /// Another number of values than signals.
    #[error(
        "the plant's process sent {have} values for its {want} signals; each line needs one value for each signal"
    )]
    ValueCount {
        /// Values in the line.
        have: usize,
        /// Signals in the first line.
        want: usize,
    },
    /// A number that is not finite.
    #[error(
        "the plant's process wrote {line:?} with a number that is not finite; shorten its integration step or check \
         plant.settings"
    )]
    NotFinite {
        /// The line; its beginning, if it is long.
        line: String,
    },
    /// The process reports that it can't continue.
    #[error("the plant's process reports: {0}")]
    Reported(String),
    /// The user has interrupted the program while it waited for the process.
    #[error("interrupted by the user")]
    Interrupted,
}

impl From<ProcessError> for PlantError {
    fn from(error: ProcessError) -> Self {
        match error {
            ProcessError::Interrupted => Self::Interrupted,
            other => Self::Failed(other.to_string()),
        }
    }
}
