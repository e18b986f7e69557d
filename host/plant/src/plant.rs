//! The contract of a plant: anything that takes a torque and turns two encoders.

use crate::{Numbers, PlantError, Release, Signal};

/// Positions of the two shafts that carry encoders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Positions {
    /// Motor position theta_e in rad.
    pub motor_position_rad: f64,
    /// Load position theta_s in rad.
    pub load_position_rad: f64,
}

/// What the bench imposes on a plant during a run, relative to the plant's own parameters.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Environment {
    /// Growth of the gap's half width j0 in rad; gears wear.
    pub gap_growth_rad: f64,
    /// External torque T on the load in N m, positive towards positive angles.
    pub load_torque_nm: f64,
}

/// A plant in motion: parameters and state.
///
/// The bench owns a plant as `Box<dyn Plant>` and calls, in every control period: [`set_environment`] if the plant's model
/// takes one, [`positions`] and [`truth`], then [`step`] with the torque of the drive. A period may be split into several
/// steps, because torques arrive with a delay. A run in lockstep repeats bit for bit if the plant does.
///
/// [`set_environment`]: Self::set_environment
/// [`positions`]: Self::positions
/// [`truth`]: Self::truth
/// [`step`]: Self::step
pub trait Plant: Send {
    /// Signals of the plant's truth, at most [`MAX_SIGNALS`](crate::limits::MAX_SIGNALS), constant over the plant's life. The
    /// names are unique, none is one of [`FIXED_COLUMNS`](crate::FIXED_COLUMNS), and none starts with `drive.`.
    fn signals(&self) -> &[Signal];

    /// Writes the present values, in the order of [`signals`](Self::signals). `values` has one element per signal.
    fn truth(&self, values: &mut [f64]);

    /// What the encoders read.
    fn positions(&self) -> Positions;

    /// The load position that a run is judged by, in rad: by default what the encoder reads. A load with a part behind a
    /// spring is judged by that part.
    fn judged_load_position_rad(&self) -> f64 {
        self.positions().load_position_rad
    }

    /// Holds `torque_nm` at the motor for `dt_s` seconds.
    ///
    /// # Errors
    /// The input isn't finite, the state left the range of finite numbers, or the plant can't be followed any further.
    fn step(&mut self, torque_nm: f64, dt_s: f64) -> Result<(), PlantError>;

    /// Appends the state in numbers, from which [`restore`](Self::restore) continues bit for bit. Returns whether the plant has
    /// done so; the default appends nothing.
    fn save(&self, _numbers: &mut Vec<f64>) -> bool {
        false
    }

    /// Replaces the state by one that [`save`](Self::save) gave, of a plant with the same parameters. Returns whether the
    /// numbers are such a state; otherwise the plant stays as it is.
    fn restore(&mut self, _numbers: &mut Numbers<'_>) -> bool {
        false
    }

    /// Imposes wear and load torque from now on.
    ///
    /// # Errors
    /// A value is outside its range, or the plant takes no environment, which is the default.
    fn set_environment(&mut self, _environment: Environment) -> Result<(), PlantError> {
        Err(PlantError::FixedEnvironment)
    }

    /// Replaces the parameters from now on by those of a release and keeps the state.
    ///
    /// # Errors
    /// A value is outside its range, or the plant's parameters are fixed, which is the default.
    fn change_parameters(&mut self, _release: &Release<'_>) -> Result<(), PlantError> {
        Err(PlantError::FixedEnvironment)
    }
}
