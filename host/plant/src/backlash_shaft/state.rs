//! Coordinates, modes and surroundings of the backlash shaft.

use nalgebra::SVector;

use super::load_mode::MassState;
use crate::error::{in_range, within};
use crate::mode::{Contact, DryFriction};
use crate::{Mechanics, Numbers, ParameterError, SavedState};

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

impl SavedState for BacklashShaftState {
    fn save(&self, numbers: &mut Vec<f64>) {
        let Self { coordinates: at, mode } = self;
        at.x.save(numbers);
        numbers.extend([at.outer.position_rad, at.outer.velocity_rad_s]);
        numbers.extend([at.gap_position_rad, at.motor_torque_nm]);
        numbers.extend([at.surroundings.dead_zone_rad, at.surroundings.load_torque_nm]);
        mode.contact.save(numbers);
        mode.load.save(numbers);
        mode.motor.save(numbers);
    }

    fn restored(numbers: &mut Numbers<'_>) -> Option<Self> {
        let x = SavedState::restored(numbers)?;
        let mut next = || numbers.next();
        let coordinates = ShaftCoordinates {
            x,
            outer: MassState { position_rad: next()?, velocity_rad_s: next()? },
            gap_position_rad: next()?,
            motor_torque_nm: next()?,
            surroundings: Surroundings { dead_zone_rad: next()?, load_torque_nm: next()? },
        };
        let contact = SavedState::restored(numbers)?;
        let load = SavedState::restored(numbers)?;
        let motor = SavedState::restored(numbers)?;
        Some(Self { coordinates, mode: ShaftMode { contact, load, motor } })
    }
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
