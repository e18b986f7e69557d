//! Keys of the two masses, and the masses that they describe. The defaults are table 1 of the paper.

use std::f64::consts::PI;

use crate::limits::MAX_SUBSTEPS;
use crate::{Key, Mechanics, PlantError, PlantValues};

/// Keys of a plant of two masses that is integrated in `substeps` substeps by default.
pub(crate) fn keys(substeps: u32) -> Vec<Key> {
    let paper = Mechanics::paper();
    // Narrower than the plant's ranges: faults change both during the run.
    let stiffness = *Mechanics::STIFFNESS_NM_RAD.start()..=1e6;
    let dead_zone = *Mechanics::DEAD_ZONE_RAD.start()..=PI;
    vec![
        Key::integer("substeps", "", substeps, 1..=MAX_SUBSTEPS, "Integration steps per control period."),
        Key::number(
            "load_inertia_kg_m2",
            "kg m^2",
            paper.load_inertia_kg_m2,
            Mechanics::LOAD_INERTIA_KG_M2,
            "Inertia J_s of the load.",
        ),
        Key::number(
            "load_friction_nm_s_rad",
            "N m s/rad",
            paper.load_friction_nm_s_rad,
            Mechanics::LOAD_FRICTION_NM_S_RAD,
            "Viscous friction f_s of the load.",
        ),
        Key::number(
            "motor_inertia_kg_m2",
            "kg m^2",
            paper.motor_inertia_kg_m2,
            Mechanics::MOTOR_INERTIA_KG_M2,
            "Inertia J_m of the motor.",
        ),
        Key::number(
            "motor_friction_nm_s_rad",
            "N m s/rad",
            paper.motor_friction_nm_s_rad,
            Mechanics::MOTOR_FRICTION_NM_S_RAD,
            "Viscous friction f_m of the motor.",
        ),
        Key::number(
            "reduction_ratio",
            "",
            paper.ratio,
            Mechanics::RATIO,
            "Reduction ratio N0, motor revolutions per load revolution.",
        ),
        Key::number(
            "stiffness_nm_rad",
            "N m/rad",
            paper.stiffness_nm_rad,
            stiffness,
            "Stiffness K between motor and load, at the motor.",
        ),
        Key::number("dead_zone_rad", "rad", paper.dead_zone_rad, dead_zone, "Half gap j0, at the motor."),
    ]
}

impl Mechanics {
    /// The masses that these values describe.
    pub(crate) fn of(values: &PlantValues) -> Result<Self, PlantError> {
        Ok(Self {
            motor_inertia_kg_m2: values.number("motor_inertia_kg_m2")?,
            motor_friction_nm_s_rad: values.number("motor_friction_nm_s_rad")?,
            load_inertia_kg_m2: values.number("load_inertia_kg_m2")?,
            load_friction_nm_s_rad: values.number("load_friction_nm_s_rad")?,
            ratio: values.number("reduction_ratio")?,
            stiffness_nm_rad: values.number("stiffness_nm_rad")?,
            dead_zone_rad: values.number("dead_zone_rad")?,
        })
    }
}
