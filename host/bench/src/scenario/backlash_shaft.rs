//! Keys of `[plant]` with `model = "backlash-shaft"` only: the shaft's damping, friction on both sides, the motor's lag, limit
//! and delay, and changes during the run. The defaults model the paper's experiment.

use lashloop_plant::backlash_shaft::{BristleParameters, ShaftParameters, StribeckParameters};
use serde::Serialize;

use super::keys::{number_or, settings};
use super::range::positive;
use super::reader::Section;

/// Keys of the plant `backlash-shaft`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BacklashShaftSettings {
    /// Shaft damping c, in parallel to the stiffness, 0 to 1e6.
    pub shaft_damping_nm_s_rad: f64,
    /// How the load's dry friction behaves close to rest.
    pub load_friction: LoadFrictionModel,
    /// Coulomb friction F_c of the load, 0 to 1e6.
    pub load_coulomb_nm: f64,
    /// Stiction F_s of the load, from F_c to 1e6.
    pub load_stiction_nm: f64,
    /// Stribeck velocity v_s of the load, 1e-6 to 1e3.
    pub load_stribeck_rad_s: f64,
    /// Fraction by which the load's friction is larger forwards and smaller backwards, -0.9 to 0.9.
    pub load_friction_asymmetry: f64,
    /// Bristles of LuGre friction; `None` for Stribeck friction.
    #[serde(flatten)]
    pub bristles: Option<BristleSettings>,
    /// Coulomb friction F_c of the motor, 0 to 1e6.
    pub motor_coulomb_nm: f64,
    /// Stiction F_s of the motor, from F_c to 1e6.
    pub motor_stiction_nm: f64,
    /// Stribeck velocity v_s of the motor, 1e-6 to 1e3.
    pub motor_stribeck_rad_s: f64,
    /// Time constant T_i of the current loop, 0 to 1e4.
    pub current_lag_ms: f64,
    /// Limit U_max of the motor's torque, 1e-6 to 1e6.
    pub torque_saturation_nm: f64,
    /// Delay from a sample to its torque at the motor, 0 to 1,000,000.
    pub torque_delay_us: u32,
    /// External torque on the load.
    pub load_torque: LoadTorque,
    /// Growth of the gap.
    pub wear: Wear,
}

/// How the load's dry friction behaves close to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LoadFrictionModel {
    /// The load sticks and slips.
    Stribeck,
    /// The load bends bristles and creeps.
    Lugre,
}

settings! {
    /// Bristles of LuGre friction.
    pub struct BristleSettings {
        /// Bristle stiffness sigma_0, 1e-3 to 1e12.
        bristle_stiffness_nm_rad: f64 = number_or(3.4e4, BristleParameters::STIFFNESS_NM_RAD),
        /// Bristle damping sigma_1, 0 to 1e9.
        bristle_damping_nm_s_rad: f64 = number_or(300.0, BristleParameters::DAMPING_NM_S_RAD),
    }
}

settings! {
    /// `[plant.load_torque]`: an external torque on the load during an interval.
    pub struct LoadTorque {
        /// The torque, -1e6 to 1e6, positive towards positive angles.
        torque_nm: f64 = number_or(0.0, -1e6..=1e6),
        /// Begin of the interval, 0 to 1e6.
        from_s: f64 = number_or(0.0, 0.0..=FOREVER_S),
        /// End of the interval, excluded.
        until_s: f64 = number_or(FOREVER_S, positive(FOREVER_S)),
    }
}

impl LoadTorque {
    /// The torque in N m at a time of the run.
    #[must_use]
    pub fn at_nm(&self, time_s: f64) -> f64 {
        if (self.from_s..self.until_s).contains(&time_s) { self.torque_nm } else { 0.0 }
    }
}

settings! {
    /// `[plant.wear]`: linear growth of the half gap during an interval.
    pub struct Wear {
        /// Total growth, 0 to 1.
        growth_rad: f64 = number_or(0.0, 0.0..=1.0),
        /// Begin of the growth, 0 to 1e6.
        from_s: f64 = number_or(0.0, 0.0..=FOREVER_S),
        /// End of the growth.
        until_s: f64 = number_or(FOREVER_S, positive(FOREVER_S)),
    }
}

impl Wear {
    /// Growth of the half gap in rad up to a time of the run.
    #[must_use]
    pub fn at_rad(&self, time_s: f64) -> f64 {
        if time_s >= self.until_s {
            self.growth_rad
        } else {
            self.growth_rad * ((time_s - self.from_s) / (self.until_s - self.from_s)).max(0.0)
        }
    }
}

/// Far beyond the end of any run.
const FOREVER_S: f64 = 1e6;

const FRICTIONS: [(&str, LoadFrictionModel); 2] =
    [("stribeck", LoadFrictionModel::Stribeck), ("lugre", LoadFrictionModel::Lugre)];

pub(super) fn read(plant: &mut Section<'_>) -> BacklashShaftSettings {
    let friction = plant.choice("load_friction", LoadFrictionModel::Stribeck, &FRICTIONS);
    let model = friction.unwrap_or(LoadFrictionModel::Stribeck);
    let settings = BacklashShaftSettings {
        shaft_damping_nm_s_rad: plant.number(
            "shaft_damping_nm_s_rad",
            3.1e-3,
            ShaftParameters::SHAFT_DAMPING_NM_S_RAD,
        ),
        load_friction: model,
        load_coulomb_nm: torque(plant, "load_coulomb_nm", 3.40),
        load_stiction_nm: torque(plant, "load_stiction_nm", 3.82),
        load_stribeck_rad_s: velocity(plant, "load_stribeck_rad_s", 0.03),
        load_friction_asymmetry: plant.number(
            "load_friction_asymmetry",
            0.0,
            ShaftParameters::LOAD_ASYMMETRY,
        ),
        bristles: match model {
            LoadFrictionModel::Lugre => Some(BristleSettings::read(plant)),
            LoadFrictionModel::Stribeck => {
                plant.belongs_to("load_friction", "lugre", "stribeck", BristleSettings::read);
                None
            }
        },
        motor_coulomb_nm: torque(plant, "motor_coulomb_nm", 0.02),
        motor_stiction_nm: torque(plant, "motor_stiction_nm", 0.025),
        motor_stribeck_rad_s: velocity(plant, "motor_stribeck_rad_s", 0.2),
        current_lag_ms: plant.number("current_lag_ms", 0.5, 0.0..=1e3 * ShaftParameters::CURRENT_LAG_S.end()),
        torque_saturation_nm: plant.number(
            "torque_saturation_nm",
            20.0,
            ShaftParameters::TORQUE_SATURATION_NM,
        ),
        torque_delay_us: plant.integer("torque_delay_us", 1000, 0..=1_000_000),
        load_torque: plant.section("load_torque", |section| {
            let load = LoadTorque::read(section);
            check_times(section, load.from_s, load.until_s);
            load
        }),
        wear: plant.section("wear", |section| {
            let wear = Wear::read(section);
            check_times(section, wear.from_s, wear.until_s);
            wear
        }),
    };
    for (coulomb, stiction, [less, more]) in [
        ("load_coulomb_nm", "load_stiction_nm", [settings.load_coulomb_nm, settings.load_stiction_nm]),
        ("motor_coulomb_nm", "motor_stiction_nm", [settings.motor_coulomb_nm, settings.motor_stiction_nm]),
    ] {
        // The error names the key that the scenario gives: the other may be a default.
        if more < less && plant.node(stiction).is_some() {
            plant.reject(stiction, format!("is less than {coulomb}; it must be >= {less} N m"));
        } else if more < less {
            plant.reject(coulomb, format!("is more than {stiction}; it must be <= {more} N m"));
        }
    }
    settings
}

fn torque(plant: &mut Section<'_>, key: &'static str, default: f64) -> f64 {
    plant.number(key, default, StribeckParameters::TORQUE_NM)
}

fn velocity(plant: &mut Section<'_>, key: &'static str, default: f64) -> f64 {
    plant.number(key, default, StribeckParameters::VELOCITY_RAD_S)
}

/// Checks that an interval ends after its begin.
fn check_times(section: &Section<'_>, from_s: f64, until_s: f64) {
    if until_s <= from_s && section.node("until_s").is_some() {
        section.reject("until_s", format!("is not after from_s; it must be > {from_s} s"));
    } else if until_s <= from_s {
        section.reject("from_s", format!("is the end of time; it must be < {until_s} s"));
    }
}
