//! Where the finished steps of a run go.

use super::error::RunError;
use crate::atomic_file::WriteError;
use crate::record::trace::TraceRow;
use crate::timing::StepTiming;

/// A finished step.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// The plant's true state, the torque and the drive's estimates.
    pub row: TraceRow,
    /// How the step went in time.
    pub timing: StepTiming,
}

/// Observes the steps of a run: a record, a progress bar, a plot. Never on the loop's thread in real time.
pub trait StepObserver {
    /// A step is finished.
    ///
    /// # Errors
    /// The step can't be recorded; the run ends.
    fn step(&mut self, _step: &Step) -> Result<(), WriteError> {
        Ok(())
    }

    /// Whether the run is to end early. Polled in every step.
    fn stop_asked(&self) -> bool {
        false
    }
}

/// Takes steps on the loop's own thread.
pub(super) trait StepSink {
    /// Takes the next step.
    ///
    /// # Errors
    /// The step can't be kept; the run ends.
    fn take(&mut self, step: Step) -> Result<(), RunError>;

    /// Whether the run is to end early. Polled in every step.
    fn stop_asked(&self) -> bool;
}
