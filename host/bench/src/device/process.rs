//! The process that runs a drive: its start, and how long it may take.

use std::time::Duration;

use super::error::DeviceError;
use crate::supervisor::{Process, Program, Supervisor};

/// Time that a program may take to come up.
pub(super) const START_LIMIT: Duration = Duration::from_secs(5);
/// Time that a failing program may take to end. Its standard error is complete only then.
const END_LIMIT: Duration = Duration::from_millis(200);

pub(super) fn spawn(supervisor: &Supervisor, program: &Program) -> Result<Process, DeviceError> {
    supervisor.spawn(program).map_err(|source| DeviceError::Spawn { name: program.name, source })
}

/// The error for a program that did not come up.
pub(super) fn not_up(process: &Process) -> DeviceError {
    let _ = process.ended_within(END_LIMIT);
    DeviceError::NotUp { name: process.name, stderr: process.stderr_head() }
}
