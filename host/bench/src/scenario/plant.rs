//! `[plant]`: a registered model, the values of its keys, and where it is released.
//!
//! A model declares its keys as data ([`lashloop_plant::Key`]); `plant_keys` reads them. What every
//! model has is declared here: `model`, `[plant.initial]`, and the environment of a model that takes one.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lashloop_plant::{Plant, PlantError, PlantModel, PlantValue, PlantValues, Plants, Release, Start};
use lashloop_plant::{TORQUE_DELAY_US, smooth};
use serde::{Serialize, Serializer};

use super::declare::{Field, Settings, name_of, number, plain, section, section_of};
use super::electrical::ElectricalSettings;
use super::environment::EnvironmentSettings;
use super::key::{Choice, Keys, Selector};
use super::plant_keys;
use super::reader::Section;
use super::sections::RunSettings;
use crate::process_plant;
use crate::settings;

/// The plant of a scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlantSettings {
    /// The model.
    #[serde(serialize_with = "as_name")]
    pub model: Arc<PlantModel>,
    /// The values of the model's keys.
    #[serde(flatten)]
    pub values: PlantValues,
    /// Wear and load torque; `None` for a model that takes neither.
    #[serde(flatten)]
    pub environment: Option<EnvironmentSettings>,
    /// The motor's circuit; `None` for a stage that makes the torque of its command.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub electrical: Option<ElectricalSettings>,
    /// `[plant.initial]`: positions and velocities at time 0, -1e4 to 1e4.
    pub initial: Start,
    /// Folder of the scenario, at which relative paths start.
    #[serde(skip)]
    pub folder: PathBuf,
}

fn as_name<S: Serializer>(model: &PlantModel, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(model.name())
}

impl PlantSettings {
    /// The number of a key, whole or not; `None` if the model has no such key, or the key no number.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<f64> {
        match self.values.get(key)? {
            PlantValue::Number(number) => Some(*number),
            // Keys of plants have 32 bits.
            PlantValue::Integer(number) => Some(*number as f64),
            _ => None,
        }
    }

    /// Delay from a sample to its torque at the motor, 0 unless the model has the key [`TORQUE_DELAY_US`].
    #[must_use]
    pub fn torque_delay_us(&self) -> u32 {
        self.values.integer(TORQUE_DELAY_US).unwrap_or(0)
    }

    /// The plant, released at its initial state, behind its bridge if it has one.
    ///
    /// # Errors
    /// The model can't build a plant from these values, or not for this control period.
    pub fn release(&self, run: &RunSettings) -> Result<Box<dyn Plant>, PlantError> {
        let plant = self.model.release(&self.with(&self.values, run.control_period_s()))?;
        match &self.electrical {
            None => Ok(plant),
            Some(electrical) => electrical.behind_bridge(plant, run.seed),
        }
    }

    /// What a plant of this model is built from with other values.
    #[must_use]
    pub fn with<'a>(&'a self, values: &'a PlantValues, period_s: f64) -> Release<'a> {
        Release { values, start: self.initial, period_s, folder: &self.folder }
    }
}

/// The models of a scenario that is read without a registry of its own.
#[must_use]
pub fn standard() -> Plants {
    Plants::standard().with(process_plant::model(None)).with(process_plant::fmu(None))
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

settings! {
    /// The default is the paper's start at rest.
    impl Start {
        /// Position of the load.
        load_position_rad = number(-1e4..=1e4).or(FRAC_PI_2),
        /// Velocity of the load.
        load_velocity_rad_s = number(-1e4..=1e4).or(0.0),
        /// Position of the motor.
        motor_position_rad = number(-1e4..=1e4).or(3.0 * FRAC_PI_2),
        /// Velocity of the motor.
        motor_velocity_rad_s = number(-1e4..=1e4).or(0.0),
    }
}

/// `[plant]` with these models to choose from.
pub(super) fn field<'a>(plants: &'a Plants, folder: &'a Path) -> impl Field<Value = PlantSettings> + 'a {
    section_of(|plant| read(plant, plants, folder))
}

fn keys_of(model: &PlantModel) -> Keys {
    Section::keys_of(|plant| {
        plant_keys::describe(plant, model.keys());
        if model.changes().environment {
            EnvironmentSettings::read(plant);
        }
    })
}

fn read(plant: &mut Section<'_>, plants: &Plants, folder: &Path) -> PlantSettings {
    let models = plants.iter().map(|model| Choice { name: model.name(), doc: model.summary() });
    let chosen = name_of(models.collect()).find("model", "Model of the plant.", plant);
    let chosen = chosen.and_then(|name| plants.iter().find(|model| model.name() == name));
    let model = chosen.cloned().unwrap_or_else(|| {
        // The known keys depend on a choice that is faulty itself. Most plants have those of the smooth one.
        plant.accept_the_rest();
        Arc::new(smooth::model())
    });
    plant.describe(|keys| {
        keys.symbols = SYMBOLS;
        let variants = plants.iter().map(|model| (model.name(), keys_of(model))).collect();
        keys.selectors.push(Selector { key: "model", variants, names_owner: true });
    });
    // The description has them as keys of each model.
    let described = plant.keys.take();
    let values = plant_keys::read(plant, model.keys());
    let has_environment = chosen.is_some_and(|model| model.changes().environment);
    let environment = has_environment.then(|| EnvironmentSettings::read(plant));
    plant.keys = described;
    let doc = "A motor on a bridge between the torque of the drive and the plant; without this section every torque is as commanded.";
    let electrical = section_of(ElectricalSettings::read).read("electrical", doc, plant);
    let electrical = plant.has("electrical").then_some(electrical);
    let initial = section(plain).read("initial", "Positions and velocities at time 0.", plant);
    PlantSettings { model, values, environment, electrical, initial, folder: folder.to_owned() }
}
