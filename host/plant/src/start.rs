//! The initial condition of a plant, and all that a plant is built from.

use std::path::Path;

use nalgebra::Vector6;
use serde::Serialize;

use crate::PlantValues;

/// Positions and velocities at which a plant is released.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Start {
    /// Load position theta_s in rad.
    pub load_position_rad: f64,
    /// Load velocity in rad/s.
    pub load_velocity_rad_s: f64,
    /// Motor position theta_e in rad.
    pub motor_position_rad: f64,
    /// Motor velocity in rad/s.
    pub motor_velocity_rad_s: f64,
}

impl Start {
    /// Released at rest.
    pub const fn at_rest(load_position_rad: f64, motor_position_rad: f64) -> Self {
        Self { load_position_rad, load_velocity_rad_s: 0.0, motor_position_rad, motor_velocity_rad_s: 0.0 }
    }

    /// The state vector at the release, without energy supplied or dissipated.
    pub(crate) fn coordinates(&self) -> Vector6<f64> {
        let Self { load_position_rad, load_velocity_rad_s, motor_position_rad, motor_velocity_rad_s } = *self;
        Vector6::new(
            load_position_rad,
            load_velocity_rad_s,
            motor_position_rad,
            motor_velocity_rad_s,
            0.0,
            0.0,
        )
    }
}

/// Initial state and parameters of a plant that is to be built.
#[derive(Debug, Clone, Copy)]
pub struct Release<'a> {
    /// Values of the model's keys.
    pub values: &'a PlantValues,
    /// Positions and velocities at time 0.
    pub start: Start,
    /// Control period in s.
    pub period_s: f64,
    /// Folder at which relative paths of the values start; empty for the working folder.
    pub folder: &'a Path,
}
