//! Why a step fails.

use lashloop_plant::PlantError;

use super::error::RunError;
use super::outcome::End;
use crate::device::DeviceError;

/// Why a step could not be made.
pub(super) enum StepError {
    /// The plant can't go on: a result of the run.
    Plant(PlantError),
    /// The run can't go on: no result.
    Run(RunError),
}

impl StepError {
    /// The end of the run that this is, if it is one.
    pub(super) fn end(self) -> Result<End, RunError> {
        match self {
            Self::Plant(error) => Ok(End::Diverged(error)),
            Self::Run(error) => Err(error),
        }
    }
}

impl From<PlantError> for StepError {
    fn from(error: PlantError) -> Self {
        Self::Plant(error)
    }
}

impl From<RunError> for StepError {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<DeviceError> for StepError {
    fn from(error: DeviceError) -> Self {
        Self::Run(error.into())
    }
}
