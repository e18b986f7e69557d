//! Parameters of the backlash shaft, validated and prepared for the integration.

use super::lugre::LoadFriction;
use super::parameters::ShaftParameters;
use super::stribeck::Stribeck;
use crate::error::validate_substeps;
use crate::{Mechanics, ParameterError};

/// Parameters of the backlash shaft, with the quantities derived from them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BacklashShaft {
    pub(super) mechanics: Mechanics,
    pub(super) parameters: ShaftParameters,
    pub(super) load_friction: LoadFriction,
    pub(super) motor_friction: Stribeck,
    /// 1 / J_s and 1 / J_m: a division would take longer than the rest of a right-hand side.
    pub(super) per_load_inertia: f64,
    pub(super) per_motor_inertia: f64,
    pub(super) substeps: u32,
}

impl BacklashShaft {
    /// A plant integrated in at least `substeps` substeps per step; 16 per millisecond leave an error of 1e-9 rad at the
    /// load.
    ///
    /// # Errors
    /// Names the first parameter outside its range.
    pub fn new(
        mechanics: Mechanics,
        parameters: ShaftParameters,
        substeps: u32,
    ) -> Result<Self, ParameterError> {
        mechanics.validate()?;
        parameters.validate()?;
        validate_substeps(substeps)?;
        let curve = Stribeck::new(parameters.load, parameters.load_asymmetry);
        let load_friction = LoadFriction { curve, bristles: parameters.load_bristles };
        let motor_friction = Stribeck::new(parameters.motor, 0.0);
        Ok(Self {
            mechanics,
            parameters,
            load_friction,
            motor_friction,
            per_load_inertia: 1.0 / mechanics.load_inertia_kg_m2,
            per_motor_inertia: 1.0 / mechanics.motor_inertia_kg_m2,
            substeps,
        })
    }
}
