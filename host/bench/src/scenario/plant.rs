//! `[plant]`: the load, the motor and the gap between them. The defaults are table 1 of the paper.

use std::f64::consts::{FRAC_PI_2, PI};

pub use lashloop_plant::PlantModel;
use lashloop_plant::{Mechanics, Start};
use serde::Serialize;

use super::backlash_shaft::{self, BacklashShaftSettings};
use super::range::NumberRange;
use super::reader::Section;

/// The plant and how finely it is integrated. Without a range of its own a key has the range of [`Mechanics`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlantSettings {
    /// Model of the gap.
    pub model: PlantModel,
    /// Integration steps per control period, 1 to 4096.
    pub substeps: u32,
    /// Inertia J_s of the load.
    pub load_inertia_kg_m2: f64,
    /// Viscous friction f_s of the load.
    pub load_friction_nm_s_rad: f64,
    /// Inertia J_m of the motor.
    pub motor_inertia_kg_m2: f64,
    /// Viscous friction f_m of the motor.
    pub motor_friction_nm_s_rad: f64,
    /// Reduction ratio N0, motor revolutions per load revolution.
    pub reduction_ratio: f64,
    /// Stiffness K between motor and load, at the motor, 1e-6 to 1e6.
    pub stiffness_nm_rad: f64,
    /// Half gap j0, at the motor, 1e-6 to pi.
    pub dead_zone_rad: f64,
    /// Coulomb friction F_c of the load, 0 to 1e6; `None` for another model than `hard-coulomb`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_coulomb_nm: Option<f64>,
    /// Keys of the plant `backlash-shaft`; `None` for another model.
    #[serde(flatten)]
    pub backlash_shaft: Option<BacklashShaftSettings>,
    /// `[plant.initial]`: positions and velocities at time 0, -1e4 to 1e4.
    pub initial: Start,
}

/// Symbols of the paper, so that messages can name the key for a symbol.
const SYMBOLS: &[(&str, &str)] = &[
    ("k", "stiffness_nm_rad"),
    ("j0", "dead_zone_rad"),
    ("n0", "reduction_ratio"),
    ("j_s", "load_inertia_kg_m2"),
    ("f_s", "load_friction_nm_s_rad"),
    ("j_m", "motor_inertia_kg_m2"),
    ("f_m", "motor_friction_nm_s_rad"),
];

pub(super) fn read(plant: &mut Section<'_>) -> PlantSettings {
    plant.symbols(SYMBOLS);
    let model = plant.choice("model", None, &PlantModel::ALL.map(|model| (model.name(), model)));
    // Narrower than the plant's ranges: faults change both during the run.
    let stiffness = NumberRange::from(Mechanics::STIFFNESS_NM_RAD).up_to(1e6);
    let dead_zone = NumberRange::from(Mechanics::DEAD_ZONE_RAD).up_to(PI);
    let substeps = if model == Some(PlantModel::BacklashShaft) { 16 } else { 4 };
    PlantSettings {
        model: model.unwrap_or(PlantModel::Smooth),
        substeps: plant.integer("substeps", substeps, 1..=4096),
        load_inertia_kg_m2: plant.number("load_inertia_kg_m2", 7.5, Mechanics::LOAD_INERTIA_KG_M2),
        load_friction_nm_s_rad: plant.number(
            "load_friction_nm_s_rad",
            16.0,
            Mechanics::LOAD_FRICTION_NM_S_RAD,
        ),
        motor_inertia_kg_m2: plant.number("motor_inertia_kg_m2", 9.72e-4, Mechanics::MOTOR_INERTIA_KG_M2),
        motor_friction_nm_s_rad: plant.number(
            "motor_friction_nm_s_rad",
            4.3e-4,
            Mechanics::MOTOR_FRICTION_NM_S_RAD,
        ),
        reduction_ratio: plant.number("reduction_ratio", 3.0, Mechanics::RATIO),
        stiffness_nm_rad: plant.number("stiffness_nm_rad", 1.0, stiffness),
        dead_zone_rad: plant.number("dead_zone_rad", 0.16, dead_zone),
        load_coulomb_nm: read_coulomb_friction(plant, model),
        backlash_shaft: read_backlash_shaft(plant, model),
        initial: plant.section("initial", read_initial),
    }
}

/// Coulomb friction on its own is a key of `hard-coulomb`; on `smooth` it is an error, not a value without effect.
fn read_coulomb_friction(plant: &mut Section<'_>, model: Option<PlantModel>) -> Option<f64> {
    // 3.84 N m leaves the paper's static error of 0.32 rad under the uncompensated law.
    let read = |plant: &mut Section<'_>| plant.number("load_coulomb_nm", 3.84, 0.0..=1e6);
    match model {
        Some(PlantModel::Smooth) => {
            plant.belongs_to("model", PlantModel::HardCoulomb.name(), PlantModel::Smooth.name(), read);
            None
        }
        Some(PlantModel::BacklashShaft) => None,
        Some(PlantModel::HardCoulomb) | None => Some(read(plant)),
    }
}

/// Keys of `backlash-shaft`; on another model they are errors.
fn read_backlash_shaft(plant: &mut Section<'_>, model: Option<PlantModel>) -> Option<BacklashShaftSettings> {
    match model {
        Some(PlantModel::BacklashShaft) => return Some(backlash_shaft::read(plant)),
        Some(chosen @ (PlantModel::HardCoulomb | PlantModel::Smooth)) => {
            plant.belongs_to("model", PlantModel::BacklashShaft.name(), chosen.name(), backlash_shaft::read);
        }
        // The known keys depend on a choice that is faulty itself.
        None => plant.accept_the_rest(),
    }
    None
}

/// The default is the paper's start at rest.
fn read_initial(initial: &mut Section<'_>) -> Start {
    let mut number = |key, default| initial.number(key, default, -1e4..=1e4);
    Start {
        load_position_rad: number("load_position_rad", FRAC_PI_2),
        load_velocity_rad_s: number("load_velocity_rad_s", 0.0),
        motor_position_rad: number("motor_position_rad", 3.0 * FRAC_PI_2),
        motor_velocity_rad_s: number("motor_velocity_rad_s", 0.0),
    }
}
