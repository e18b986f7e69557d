//! Keys of the model `backlash-shaft`, and the plant that they describe. The defaults model the paper's experiment.

use super::parameters::{BristleParameters, ShaftParameters};
use super::shaft::BacklashShaft;
use crate::mechanics;
use crate::{Changes, Key, Mechanics, PlantError, PlantModel, PlantValues, Release, RunningPlant};

/// Name of the model in scenarios.
pub const NAME: &str = "backlash-shaft";

/// The model for scenarios.
#[must_use]
pub fn model() -> PlantModel {
    let summary = "Physical backlash with a damped shaft, Stribeck or LuGre friction, and a drive that lags and saturates.";
    let mut all = mechanics::keys(16);
    all.extend(keys());
    let changes = Changes {
        environment: true,
        stiffness: &["stiffness_nm_rad"],
        friction: &["load_coulomb_nm", "load_stiction_nm"],
    };
    let build = |release: &Release<'_>| -> Result<Box<dyn crate::Plant>, PlantError> {
        Ok(Box::new(RunningPlant::released(BacklashShaft::of(release)?, release.start)))
    };
    PlantModel::new(NAME, summary, all, build).with_changes(changes)
}

fn keys() -> Vec<Key> {
    let [
        damping,
        load_c,
        load_s,
        load_v,
        asymmetry,
        mode_fraction,
        mode_hz,
        mode_damping,
        motor_c,
        motor_s,
        motor_v,
        motor_asymmetry,
        cogging,
        cogging_per_turn,
        offset,
        saturation,
    ] = ShaftParameters::keys();
    let [bristle_stiffness, bristle_damping] =
        BristleParameters::keys().map(|key| key.only_with("load_friction", "lugre"));
    let lag_ms = 0.0..=1e3 * ShaftParameters::CURRENT_LAG_S.end();
    vec![
        damping,
        Key::choice(
            "load_friction",
            &["stribeck", "lugre"],
            "How the load's dry friction behaves close to rest: it sticks and slips, or bends bristles and creeps.",
        ),
        load_c,
        load_s.at_least("load_coulomb_nm"),
        load_v,
        asymmetry,
        bristle_stiffness,
        bristle_damping,
        mode_fraction,
        mode_hz,
        mode_damping,
        motor_c,
        motor_s.at_least("motor_coulomb_nm"),
        motor_v,
        motor_asymmetry,
        cogging,
        cogging_per_turn,
        offset,
        Key::number("current_lag_ms", "ms", 0.5, lag_ms, "Time constant T_i of the current loop."),
        saturation,
        Key::torque_delay(1000),
    ]
}

impl BacklashShaft {
    /// The plant that a release describes.
    ///
    /// # Errors
    /// A value is outside its range, or the plant is too stiff for the control period.
    pub fn of(release: &Release<'_>) -> Result<Self, PlantError> {
        let values = release.values;
        let parameters = ShaftParameters::of_all(values)?;
        let plant = Self::new(Mechanics::of(values)?, parameters, values.integer("substeps")?)?;
        // Bristles that can't be followed at the Stribeck velocity can't be followed anywhere. Others may turn out too
        // stiff when the load gets faster; the run ends there.
        let velocity_rad_s = release.start.load_velocity_rad_s.abs().max(parameters.load.velocity_rad_s);
        plant.substeps(release.period_s, velocity_rad_s)?;
        Ok(plant)
    }
}

impl ShaftParameters {
    fn of_all(values: &PlantValues) -> Result<Self, PlantError> {
        let load_bristles = match values.text("load_friction")? {
            "lugre" => Some(BristleParameters::of(values)?),
            _ => None,
        };
        let current_lag_s = values.number("current_lag_ms")? / 1e3;
        Ok(Self { load_bristles, current_lag_s, ..Self::of(values)? })
    }
}
