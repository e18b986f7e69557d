//! Where the finished steps of a run go.

use lashloop_plant::metrics::SignalTable;

use super::error::RunError;
use super::step::Step;
use crate::atomic_file::WriteError;

/// Observes the steps of a run: a record, a progress bar, a plot. Never on the loop's thread in real time.
pub trait StepObserver {
    /// The drive is set up and about to start. `signals` names the values of every step.
    ///
    /// # Errors
    /// The run can't be recorded; it ends before its first step.
    fn begin(&mut self, _signals: &SignalTable) -> Result<(), WriteError> {
        Ok(())
    }

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
