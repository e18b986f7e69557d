//! What every plant implements, and a plant with its state as one value.

use crate::{PlantError, Start, Truth};

/// A plant: constant parameters in the implementor, coordinates and modes in the state.
pub trait Plant {
    /// Coordinates and modes.
    type State: Clone;

    /// State of a plant that is released at `start`.
    fn initial_state(&self, start: Start) -> Self::State;

    /// Holds `torque_nm` at the motor for `dt_s` seconds.
    ///
    /// # Errors
    /// The input isn't finite, the state left the range of finite numbers, or contact or sticking changes without end.
    fn step(&self, state: &mut Self::State, torque_nm: f64, dt_s: f64) -> Result<(), PlantError>;

    /// Everything that can be known about a state.
    fn truth(&self, state: &Self::State) -> Truth;
}

/// A plant in motion: its parameters and its state as one value, so that neither can meet another plant's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunningPlant<P: Plant> {
    pub(crate) plant: P,
    pub(crate) state: P::State,
}

impl<P: Plant> RunningPlant<P> {
    /// A plant that is released at `start`.
    pub fn released(plant: P, start: Start) -> Self {
        let state = plant.initial_state(start);
        Self { plant, state }
    }

    /// Holds `torque_nm` at the motor for `dt_s` seconds.
    ///
    /// # Errors
    /// As [`Plant::step`].
    pub fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        self.plant.step(&mut self.state, torque_nm, dt_s)
    }

    /// Everything that can be known about the present state.
    pub fn truth(&self) -> Truth {
        self.plant.truth(&self.state)
    }
}
