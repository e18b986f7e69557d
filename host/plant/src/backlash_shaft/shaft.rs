//! Parameters of the backlash shaft, validated and prepared for the integration.

use super::cogging::Cogging;
use super::load_mode::LoadMode;
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
    pub(super) cogging: Cogging,
    pub(super) load_mode: Option<LoadMode>,
    /// 1 / J_s, of the mass at the gear if the load has two, and 1 / J_m: a division would take longer than the rest of a right-hand side.
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
        let motor_friction = Stribeck::new(parameters.motor, parameters.motor_asymmetry);
        let at_gear_kg_m2 = mechanics.load_inertia_kg_m2 * (1.0 - parameters.load_mode.fraction);
        Ok(Self {
            mechanics,
            parameters,
            load_friction,
            motor_friction,
            cogging: Cogging::new(parameters.cogging),
            load_mode: LoadMode::new(parameters.load_mode, mechanics.load_inertia_kg_m2),
            per_load_inertia: 1.0 / at_gear_kg_m2,
            per_motor_inertia: 1.0 / mechanics.motor_inertia_kg_m2,
            substeps,
        })
    }
}
