//! Keys of the model `backlash-shaft`, and the plant that they describe. The defaults model the paper's experiment.

use super::parameters::{BristleParameters, ShaftParameters, StribeckParameters};
use super::shaft::BacklashShaft;
use crate::mechanics_keys;
use crate::{Changes, Key, Mechanics, PlantError, PlantModel, PlantValues, Release, RunningPlant};

/// Name of the model in scenarios.
pub const NAME: &str = "backlash-shaft";

/// The model for scenarios.
#[must_use]
pub fn model() -> PlantModel {
    let summary = "Physical backlash with a damped shaft, Stribeck or LuGre friction, and a drive that lags and saturates.";
    let mut all = mechanics_keys::keys(16);
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

fn keys() -> [Key; 14] {
    let paper = ShaftParameters::paper();
    let torque =
        |name, default, meaning| Key::number(name, "N m", default, StribeckParameters::TORQUE_NM, meaning);
    let velocity = |name, default, meaning| {
        Key::number(name, "rad/s", default, StribeckParameters::VELOCITY_RAD_S, meaning)
    };
    [
        Key::number(
            "shaft_damping_nm_s_rad",
            "N m s/rad",
            paper.shaft_damping_nm_s_rad,
            ShaftParameters::SHAFT_DAMPING_NM_S_RAD,
            "Shaft damping c, in parallel with the stiffness.",
        ),
        Key::choice(
            "load_friction",
            &["stribeck", "lugre"],
            "How the load's dry friction behaves close to rest: it sticks and slips, or bends bristles and creeps.",
        ),
        torque("load_coulomb_nm", paper.load.coulomb_nm, "Coulomb friction F_c of the load."),
        torque("load_stiction_nm", paper.load.stiction_nm, "Stiction F_s of the load, from F_c.")
            .at_least("load_coulomb_nm"),
        velocity("load_stribeck_rad_s", paper.load.velocity_rad_s, "Stribeck velocity v_s of the load."),
        Key::number(
            "load_friction_asymmetry",
            "",
            paper.load_asymmetry,
            ShaftParameters::LOAD_ASYMMETRY,
            "Fraction by which the load's friction is larger forwards and smaller backwards.",
        ),
        Key::number(
            "bristle_stiffness_nm_rad",
            "N m/rad",
            3.4e4,
            BristleParameters::STIFFNESS_NM_RAD,
            "Bristle stiffness sigma_0.",
        )
        .only_with("load_friction", "lugre"),
        Key::number(
            "bristle_damping_nm_s_rad",
            "N m s/rad",
            300.0,
            BristleParameters::DAMPING_NM_S_RAD,
            "Bristle damping sigma_1.",
        )
        .only_with("load_friction", "lugre"),
        torque("motor_coulomb_nm", paper.motor.coulomb_nm, "Coulomb friction F_c of the motor."),
        torque("motor_stiction_nm", paper.motor.stiction_nm, "Stiction F_s of the motor, from F_c.")
            .at_least("motor_coulomb_nm"),
        velocity("motor_stribeck_rad_s", paper.motor.velocity_rad_s, "Stribeck velocity v_s of the motor."),
        Key::number(
            "current_lag_ms",
            "ms",
            0.5,
            0.0..=1e3 * ShaftParameters::CURRENT_LAG_S.end(),
            "Time constant T_i of the current loop.",
        ),
        Key::number(
            "torque_saturation_nm",
            "N m",
            paper.torque_saturation_nm,
            ShaftParameters::TORQUE_SATURATION_NM,
            "Limit U_max of the motor's torque.",
        ),
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
        let parameters = ShaftParameters::of(values)?;
        let plant = Self::new(Mechanics::of(values)?, parameters, values.integer("substeps")?)?;
        // Bristles that can't be followed at the Stribeck velocity can't be followed anywhere. Others may turn out too
        // stiff when the load gets faster; the run ends there.
        let velocity_rad_s = release.start.load_velocity_rad_s.abs().max(parameters.load.velocity_rad_s);
        plant.substeps(release.period_s, velocity_rad_s)?;
        Ok(plant)
    }
}

impl ShaftParameters {
    fn of(values: &PlantValues) -> Result<Self, PlantError> {
        let load_bristles = match values.text("load_friction")? {
            "lugre" => Some(BristleParameters {
                stiffness_nm_rad: values.number("bristle_stiffness_nm_rad")?,
                damping_nm_s_rad: values.number("bristle_damping_nm_s_rad")?,
            }),
            _ => None,
        };
        Ok(Self {
            shaft_damping_nm_s_rad: values.number("shaft_damping_nm_s_rad")?,
            load: StribeckParameters {
                coulomb_nm: values.number("load_coulomb_nm")?,
                stiction_nm: values.number("load_stiction_nm")?,
                velocity_rad_s: values.number("load_stribeck_rad_s")?,
            },
            load_asymmetry: values.number("load_friction_asymmetry")?,
            load_bristles,
            motor: StribeckParameters {
                coulomb_nm: values.number("motor_coulomb_nm")?,
                stiction_nm: values.number("motor_stiction_nm")?,
                velocity_rad_s: values.number("motor_stribeck_rad_s")?,
            },
            current_lag_s: values.number("current_lag_ms")? / 1e3,
            torque_saturation_nm: values.number("torque_saturation_nm")?,
        })
    }
}
