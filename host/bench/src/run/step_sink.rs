//! Where the finished steps of a run go.

use lashloop_plant::metrics::SignalTable;

use super::clock::Clock;
use super::error::RunError;
use super::step::Step;
use crate::atomic_file::WriteError;
use crate::device::Device;
use crate::fault::timeline::FaultEdge;
use crate::scenario::Scenario;
use lashloop_session::LogEntry;

/// A run that is about to start: its drive is set up, and its scenario resolved.
#[derive(Clone, Copy)]
pub struct RunStart<'a> {
    /// What is run.
    pub scenario: &'a Scenario,
    /// What paces it.
    pub clock: Clock,
    /// The drive, with its parameters in force.
    pub device: &'a Device,
    /// The values of every step.
    pub signals: &'a SignalTable,
}

/// What happens in a run besides its steps, at the moment that it happens.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// An injected fault begins or ends.
    Fault(FaultEdge),
    /// The drive has sent a text, or the bench remarks something about it.
    Log(LogEntry),
}

/// Observes the steps of a run: a record, a progress bar, a plot. Never on the loop's thread in real time.
pub trait StepObserver {
    /// The drive is set up and about to start.
    ///
    /// # Errors
    /// The run can't be recorded; it ends before its first step.
    fn begin(&mut self, _start: &RunStart<'_>) -> Result<(), WriteError> {
        Ok(())
    }

    /// A step is finished.
    ///
    /// # Errors
    /// The step can't be recorded; the run ends.
    fn step(&mut self, _step: &Step) -> Result<(), WriteError> {
        Ok(())
    }

    /// Something happened in a step. It comes before the step itself.
    ///
    /// # Errors
    /// The event can't be recorded; the run ends.
    fn event(&mut self, _step: u32, _event: &Event) -> Result<(), WriteError> {
        Ok(())
    }

    /// Whether the run is to end early. Polled in every step.
    fn stop_asked(&self) -> bool {
        false
    }

    /// The run has no outcome, because of this error: device, link or record failed, or the scenario does not fit the drive.
    fn failed(&mut self, _error: &RunError) {}
}

/// Several observers of one run, in this order.
pub struct Observers<'a>(pub Vec<&'a mut dyn StepObserver>);

impl StepObserver for Observers<'_> {
    fn begin(&mut self, start: &RunStart<'_>) -> Result<(), WriteError> {
        self.0.iter_mut().try_for_each(|it| it.begin(start))
    }

    fn step(&mut self, step: &Step) -> Result<(), WriteError> {
        self.0.iter_mut().try_for_each(|it| it.step(step))
    }

    fn event(&mut self, step: u32, event: &Event) -> Result<(), WriteError> {
        self.0.iter_mut().try_for_each(|it| it.event(step, event))
    }

    fn stop_asked(&self) -> bool {
        self.0.iter().any(|it| it.stop_asked())
    }

    fn failed(&mut self, error: &RunError) {
        self.0.iter_mut().for_each(|it| it.failed(error));
    }
}

/// A finished step, or what happens in a step.
#[expect(
    clippy::large_enum_variant,
    reason = "nearly every item is a step, and a box would be an allocation on the loop's thread"
)]
pub(super) enum Item {
    Step(Step),
    Event { step: u32, event: Event },
}

/// Takes steps on the loop's own thread.
pub(super) trait StepSink {
    /// Takes the next step or event.
    ///
    /// # Errors
    /// It can't be kept; the run ends.
    fn take(&mut self, item: Item) -> Result<(), RunError>;

    /// Whether the run is to end early. Polled in every step.
    fn stop_asked(&self) -> bool;
}
