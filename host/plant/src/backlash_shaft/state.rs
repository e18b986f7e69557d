//! Coordinates, modes and surroundings of the backlash shaft.

use nalgebra::SVector;

use super::load_mode::MassState;
use crate::error::{in_range, within};
use crate::mode::{Contact, DryFriction};
use crate::{Mechanics, ParameterError};

/// Index of the bristles' deflection in the state vector, after the coordinates of every plant.
pub(super) const BRISTLE: usize = 6;

/// The mode, which selects the right-hand side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShaftMode {
    pub(super) contact: Contact,
    pub(super) load: DryFriction,
    pub(super) motor: DryFriction,
}

/// Coordinates, and the surroundings they move in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaftCoordinates {
    pub(super) x: SVector<f64, 7>,
    /// The load's outer mass; without a load mode it stays where the load started.
    pub(super) outer: MassState,
    /// theta_b.
    pub(super) gap_position_rad: f64,
    /// tau.
    pub(super) motor_torque_nm: f64,
    pub(super) surroundings: Surroundings,
}

/// Coordinates and mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashShaftState {
    pub(super) coordinates: ShaftCoordinates,
    pub(super) mode: ShaftMode,
}

/// Gap and load torque, which may change at every step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Surroundings {
    /// j0 in rad, half the gap; it grows as gears wear.
    pub(super) dead_zone_rad: f64,
    /// External torque T on the load in N m.
    pub(super) load_torque_nm: f64,
}

impl Surroundings {
    /// Checks both values.
    ///
    /// # Errors
    /// Names the value outside its range.
    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        in_range("dead_zone_rad", self.dead_zone_rad, &Mechanics::DEAD_ZONE_RAD)?;
        within("load_torque_nm", self.load_torque_nm, -1e6, 1e6)
    }
}
