//! The plant that a scenario describes.

use crate::scenario::backlash_shaft::BacklashShaftSettings;
use crate::scenario::plant::{PlantModel, PlantSettings};
use lashloop_plant::backlash_shaft::{
    BacklashShaft, BristleParameters, Environment, ShaftParameters, StribeckParameters,
};
use lashloop_plant::hard_coulomb::HardCoulomb;
use lashloop_plant::smooth::Smooth;
use lashloop_plant::{AnyPlant, Mechanics, PlantError, RunningPlant};

use super::error::RunError;

/// The plant of a scenario, released at its initial state.
///
/// # Errors
/// A parameter is outside its range, or the plant is too stiff for the control period.
pub(super) fn plant(settings: &PlantSettings, period_s: f64) -> Result<AnyPlant, RunError> {
    let start = settings.initial;
    Ok(match settings.model {
        PlantModel::BacklashShaft => {
            AnyPlant::BacklashShaft(RunningPlant::released(changed(settings, period_s)?, start))
        }
        PlantModel::HardCoulomb => {
            let coulomb_nm = settings.load_coulomb_nm.unwrap_or_default();
            let plant = HardCoulomb::new(mechanics(settings), coulomb_nm, settings.substeps)?;
            AnyPlant::HardCoulomb(RunningPlant::released(plant, start))
        }
        PlantModel::Smooth => {
            let plant = Smooth::new(mechanics(settings), settings.substeps)?;
            AnyPlant::Smooth(RunningPlant::released(plant, start))
        }
    })
}

/// The parameters of the one plant that changes while it runs.
///
/// # Errors
/// As [`plant`], or the scenario has another plant.
pub(super) fn changed(settings: &PlantSettings, period_s: f64) -> Result<BacklashShaft, RunError> {
    let own = settings.backlash_shaft.as_ref();
    let own = own.ok_or(PlantError::FixedEnvironment { plant: settings.model.name() })?;
    let plant = BacklashShaft::new(mechanics(settings), parameters(own), settings.substeps)?;
    // Bristles that can't be followed at the Stribeck velocity can't be followed anywhere. Others may turn out too
    // stiff when the load gets faster; the run ends there.
    let velocity_rad_s = settings.initial.load_velocity_rad_s.abs().max(own.load_stribeck_rad_s);
    plant.substeps(period_s, velocity_rad_s)?;
    Ok(plant)
}

fn mechanics(settings: &PlantSettings) -> Mechanics {
    Mechanics {
        motor_inertia_kg_m2: settings.motor_inertia_kg_m2,
        motor_friction_nm_s_rad: settings.motor_friction_nm_s_rad,
        load_inertia_kg_m2: settings.load_inertia_kg_m2,
        load_friction_nm_s_rad: settings.load_friction_nm_s_rad,
        ratio: settings.reduction_ratio,
        stiffness_nm_rad: settings.stiffness_nm_rad,
        dead_zone_rad: settings.dead_zone_rad,
    }
}

fn parameters(shaft: &BacklashShaftSettings) -> ShaftParameters {
    ShaftParameters {
        shaft_damping_nm_s_rad: shaft.shaft_damping_nm_s_rad,
        load: StribeckParameters {
            coulomb_nm: shaft.load_coulomb_nm,
            stiction_nm: shaft.load_stiction_nm,
            velocity_rad_s: shaft.load_stribeck_rad_s,
        },
        load_asymmetry: shaft.load_friction_asymmetry,
        load_bristles: shaft.bristles.as_ref().map(|bristles| BristleParameters {
            stiffness_nm_rad: bristles.bristle_stiffness_nm_rad,
            damping_nm_s_rad: bristles.bristle_damping_nm_s_rad,
        }),
        motor: StribeckParameters {
            coulomb_nm: shaft.motor_coulomb_nm,
            stiction_nm: shaft.motor_stiction_nm,
            velocity_rad_s: shaft.motor_stribeck_rad_s,
        },
        current_lag_s: shaft.current_lag_ms / 1e3,
        torque_saturation_nm: shaft.torque_saturation_nm,
    }
}

/// Gap and load torque at a time of the run; `None` for a plant with a fixed environment.
pub(super) fn environment(settings: &PlantSettings, time_s: f64) -> Option<Environment> {
    settings.backlash_shaft.as_ref().map(|shaft| Environment {
        dead_zone_rad: settings.dead_zone_rad + shaft.wear.at_rad(time_s),
        load_torque_nm: shaft.load_torque.at_nm(time_s),
    })
}
