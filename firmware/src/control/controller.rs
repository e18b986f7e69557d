//! What every control law offers.

use crate::control::{ControlOutput, Measurement, Real};

/// A control law. Parameters live in the implementor and never change in a run; what changes lives in the state.
pub trait Controller<F: Real> {
    /// What the law remembers from sample to sample.
    type State;

    /// The state at the first sample.
    fn initial_state(&self) -> Self::State;

    /// One sample: the torque wanted now, before any limit of the drive.
    fn step(&self, state: &mut Self::State, measurement: &Measurement<F>) -> ControlOutput<F>;
}
