//! The interface of a control law, and a law with its state as one value.

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

/// A controller that owns its state, so that no other controller's state can be passed to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Stateful<F: Real, C: Controller<F>> {
    controller: C,
    state: C::State,
}

impl<F: Real, C: Controller<F>> Stateful<F, C> {
    /// The controller in its initial state.
    pub fn new(controller: C) -> Self {
        Self { state: controller.initial_state(), controller }
    }

    /// The torque for one sample, before the drive's limit.
    pub fn step(&mut self, measurement: &Measurement<F>) -> ControlOutput<F> {
        self.controller.step(&mut self.state, measurement)
    }
}
