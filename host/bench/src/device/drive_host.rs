//! The host of a drive: this process, another one or a board, and how it is started and suspended.

use std::time::Duration;

use lashloop_link::in_process::Suspension;

use super::error::DeviceError;
use crate::supervisor::{Process, Program, Supervisor};

/// Time that a program may take to come up.
pub(super) const START_LIMIT: Duration = Duration::from_secs(5);
/// Time that a failing program may take to end. Its standard error is complete only then.
const END_LIMIT: Duration = Duration::from_millis(200);

/// The host of a drive, and with it how the drive can be suspended.
pub enum DriveHost {
    /// This process; the drive has none of its own.
    InProcess(Suspension),
    /// A process that the bench started, and stops and continues by signals.
    Process(Process),
    /// A board, or a process of another program; the bench can't suspend it.
    External,
}

impl DriveHost {
    /// The process behind the drive, if the bench started one.
    #[must_use]
    pub fn process(&self) -> Option<&Process> {
        match self {
            Self::Process(process) => Some(process),
            Self::InProcess(_) | Self::External => None,
        }
    }

    /// Time in which a process that the bench started computed or waited for a core.
    #[must_use]
    pub fn busy(&self) -> Duration {
        self.process().map_or(Duration::ZERO, |process| process.watch.busy())
    }

    /// Whether the bench has started the drive and can suspend it.
    #[must_use]
    pub fn is_started(&self) -> bool {
        match self {
            Self::Process(_) | Self::InProcess(_) => true,
            Self::External => false,
        }
    }

    /// Suspends or resumes the drive. A suspended drive takes no byte and no tick, and its time continues.
    pub fn set_suspended(&self, is_suspended: bool) {
        match self {
            Self::InProcess(suspension) => suspension.set(is_suspended),
            Self::Process(process) => process.set_suspended(is_suspended),
            Self::External => {}
        }
    }
}

pub(super) fn spawn(supervisor: &Supervisor, program: &Program) -> Result<Process, DeviceError> {
    supervisor.spawn(program).map_err(|source| DeviceError::Spawn { name: program.name, source })
}

/// The error for a program that did not come up.
pub(super) fn not_up(process: &Process) -> DeviceError {
    let _ = process.ended_within(END_LIMIT);
    DeviceError::NotUp { name: process.name, stderr: process.stderr() }
}
