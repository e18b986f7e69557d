//! A controller and its state as one value.

use crate::control::{ControlOutput, Controller, Measurement, Real};

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
