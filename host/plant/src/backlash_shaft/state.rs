//! Coordinates and modes of the backlash shaft.

use nalgebra::SVector;

use super::environment::Environment;
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
