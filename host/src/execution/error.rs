//! Why there is no run.

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::device::DeviceError;
use lashloop_bench::run::RunError;
use lashloop_bench::verdict::Exit;

use crate::rig::RigError;

/// Why an execution has no outcome.
#[derive(Debug, thiserror::Error)]
pub enum ExecutionError {
    /// The rig is absent or in use, or the scenario exceeds it.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// Drive, link, plant or record failed, or the scenario doesn't fit the drive.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl ExecutionError {
    /// The exit code of a command that fails so.
    #[must_use]
    pub fn exit(&self) -> Exit {
        match self {
            Self::Rig(error) => error.exit(),
            Self::Run(error) => error.exit(),
        }
    }
}

impl From<DeviceError> for ExecutionError {
    fn from(error: DeviceError) -> Self {
        Self::Run(error.into())
    }
}

impl From<WriteError> for ExecutionError {
    fn from(error: WriteError) -> Self {
        Self::Run(error.into())
    }
}
