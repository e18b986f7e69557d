//! The interface of a control law.

use crate::control::{ControlOutput, Measurement, Real};

/// The configuration of a control law, constant in a run. What changes is in the state.
pub trait Controller<F: Real> {
    /// State of the law from sample to sample.
    type State;

    /// The state before the first sample.
    fn initial_state(&self) -> Self::State;

    /// The torque for one sample, before the drive's limit.
    fn step(&self, state: &mut Self::State, measurement: &Measurement<F>) -> ControlOutput<F>;
}
