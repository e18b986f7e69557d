//! Plants of two masses, a spring and a gap, and such a plant with its state as one value.

use crate::truth::SIGNALS;
use crate::{Environment, Numbers, Plant, PlantError, Positions, Release, SavedState, Signal, Start, Truth};

/// Two masses, a spring and a gap: constant parameters in the implementor, coordinates and modes in the state.
pub trait TwoMass {
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

    /// Positions of motor and load in a state.
    fn positions(&self, state: &Self::State) -> Positions {
        let Truth { motor_position_rad, load_position_rad, .. } = self.truth(state);
        Positions { motor_position_rad, load_position_rad }
    }

    /// The load position that a run is judged by, in rad: by default that of the encoder.
    fn judged_load_position_rad(&self, state: &Self::State) -> f64 {
        self.positions(state).load_position_rad
    }

    /// Imposes wear and load torque on a state.
    ///
    /// # Errors
    /// As [`Plant::set_environment`].
    fn set_environment(&self, _state: &mut Self::State, _environment: Environment) -> Result<(), PlantError> {
        Err(PlantError::FixedEnvironment)
    }

    /// Replaces the parameters by those of a release and keeps the state.
    ///
    /// # Errors
    /// As [`Plant::change_parameters`].
    fn change_parameters(
        &mut self,
        _state: &mut Self::State,
        _release: &Release<'_>,
    ) -> Result<(), PlantError> {
        Err(PlantError::FixedEnvironment)
    }
}

/// A plant of two masses in motion: its parameters and its state as one value, so that neither can meet another plant's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunningPlant<P: TwoMass> {
    pub(crate) plant: P,
    pub(crate) state: P::State,
}

impl<P: TwoMass> RunningPlant<P> {
    /// A plant that is released at `start`.
    pub fn released(plant: P, start: Start) -> Self {
        let state = plant.initial_state(start);
        Self { plant, state }
    }

    /// Holds `torque_nm` at the motor for `dt_s` seconds.
    ///
    /// # Errors
    /// As [`TwoMass::step`].
    pub fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        self.plant.step(&mut self.state, torque_nm, dt_s)
    }

    /// Everything that can be known about the present state.
    pub fn truth(&self) -> Truth {
        self.plant.truth(&self.state)
    }
}

impl<P: TwoMass<State: SavedState + Send> + Send> Plant for RunningPlant<P> {
    fn signals(&self) -> &[Signal] {
        &SIGNALS
    }

    fn truth(&self, values: &mut [f64]) {
        for (value, truth) in values.iter_mut().zip(self.truth().values()) {
            *value = truth;
        }
    }

    fn positions(&self) -> Positions {
        self.plant.positions(&self.state)
    }

    fn judged_load_position_rad(&self) -> f64 {
        self.plant.judged_load_position_rad(&self.state)
    }

    fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError> {
        self.step(torque_nm, dt_s)
    }

    fn save(&self, numbers: &mut Vec<f64>) -> bool {
        self.state.save(numbers);
        true
    }

    fn restore(&mut self, numbers: &mut Numbers<'_>) -> bool {
        SavedState::restored(numbers).map(|state| self.state = state).is_some()
    }

    fn set_environment(&mut self, environment: Environment) -> Result<(), PlantError> {
        self.plant.set_environment(&mut self.state, environment)
    }

    fn change_parameters(&mut self, release: &Release<'_>) -> Result<(), PlantError> {
        self.plant.change_parameters(&mut self.state, release)
    }
}
