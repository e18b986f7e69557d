//! Coordinates, modes and environment of the backlash shaft.

use nalgebra::SVector;

use crate::ParameterError;
use crate::error::within;
use crate::mode::{Contact, DryFriction};

/// Index of the bristles' deflection in the state vector, after the coordinates of every plant.
pub(super) const BRISTLE: usize = 6;

/// The mode, which selects the right-hand side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShaftMode {
    pub(super) contact: Contact,
    pub(super) load: DryFriction,
    pub(super) motor: DryFriction,
}

/// Coordinates, and the environment they move in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaftCoordinates {
    pub(super) x: SVector<f64, 7>,
    /// theta_b.
    pub(super) gap_position_rad: f64,
    /// tau.
    pub(super) motor_torque_nm: f64,
    pub(super) environment: Environment,
}

/// Coordinates and mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashShaftState {
    pub(super) coordinates: ShaftCoordinates,
    pub(super) mode: ShaftMode,
}

/// Gap and load torque, which may change at every step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Environment {
    /// j0 in rad, half the gap; it grows as gears wear.
    pub dead_zone_rad: f64,
    /// External torque T on the load in N m.
    pub load_torque_nm: f64,
}

impl Environment {
    /// Checks both values.
    ///
    /// # Errors
    /// Names the value outside its range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("dead_zone_rad", self.dead_zone_rad, 1e-6, 10.0)?;
        within("load_torque_nm", self.load_torque_nm, -1e6, 1e6)
    }
}
