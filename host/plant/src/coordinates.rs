//! The order of coordinates in the state vector of every plant of two masses.

use crate::Positions;

/// Index of the load position in a state vector.
pub(crate) const LOAD_POSITION: usize = 0;
/// Index of the load velocity in a state vector.
pub(crate) const LOAD_VELOCITY: usize = 1;
/// Index of the motor position in a state vector.
pub(crate) const MOTOR_POSITION: usize = 2;
/// Index of the motor velocity in a state vector.
pub(crate) const MOTOR_VELOCITY: usize = 3;
/// Index of the energy supplied since the start in a state vector.
pub(crate) const SUPPLIED: usize = 4;
/// Index of the energy dissipated since the start in a state vector.
pub(crate) const DISSIPATED: usize = 5;

/// The positions in a state vector.
pub(crate) fn positions(x: &[f64]) -> Positions {
    Positions { motor_position_rad: x[MOTOR_POSITION], load_position_rad: x[LOAD_POSITION] }
}
