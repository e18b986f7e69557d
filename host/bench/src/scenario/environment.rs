//! `[plant.wear]` and `[plant.load_torque]`: what changes around a plant while it runs, for models that take it.

use lashloop_plant::Environment;
use serde::Serialize;

use super::keys::{number_or, settings};
use super::range::positive;
use super::reader::Section;

/// Wear and load torque over the time of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnvironmentSettings {
    /// External torque on the load.
    pub load_torque: LoadTorque,
    /// Growth of the gap.
    pub wear: Wear,
}

impl EnvironmentSettings {
    /// Wear and load torque at a time of the run.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Environment {
        Environment {
            gap_growth_rad: self.wear.at_rad(time_s),
            load_torque_nm: self.load_torque.at_nm(time_s),
        }
    }
}

settings! {
    /// `[plant.load_torque]`: an external torque on the load during an interval.
    pub struct LoadTorque {
        /// The torque, positive towards positive angles.
        torque_nm: f64 = number_or(0.0, -1e6..=1e6),
        /// Begin of the interval.
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
        /// Total growth.
        growth_rad: f64 = number_or(0.0, 0.0..=1.0),
        /// Begin of the growth.
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

pub(super) fn read(plant: &mut Section<'_>) -> EnvironmentSettings {
    EnvironmentSettings {
        load_torque: plant.doc("An external torque on the load during an interval.").section(
            "load_torque",
            |section| {
                let load = LoadTorque::read(section);
                check_times(section, load.from_s, load.until_s);
                load
            },
        ),
        wear: plant.doc("Linear growth of the half gap during an interval.").section("wear", |section| {
            let wear = Wear::read(section);
            check_times(section, wear.from_s, wear.until_s);
            wear
        }),
    }
}

/// Checks that an interval ends after its begin.
fn check_times(section: &Section<'_>, from_s: f64, until_s: f64) {
    if until_s <= from_s && section.node("until_s").is_some() {
        section.reject("until_s", format!("is not after from_s; it must be > {from_s} s"));
    } else if until_s <= from_s {
        section.reject("from_s", format!("is the end of time; it must be < {until_s} s"));
    }
}
