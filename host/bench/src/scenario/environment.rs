//! `[plant.wear]` and `[plant.load_torque]`: what changes around a plant while it runs, for models that take it.

use lashloop_plant::Environment;
use serde::Serialize;

use super::declare::{number, section};
use super::range::positive;
use super::reader::Section;
use crate::settings;

settings! {
    /// Wear and load torque over the time of a run.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct EnvironmentSettings {
        /// An external torque on the load during an interval.
        pub load_torque: LoadTorque = section(LoadTorque::checked),
        /// Linear growth of the half gap during an interval.
        pub wear: Wear = section(Wear::checked),
    }
}

impl EnvironmentSettings {
    /// Whether neither load torque nor wear acts.
    #[must_use]
    pub fn is_absent(&self) -> bool {
        self.load_torque.torque_nm == 0.0 && self.wear.growth_rad == 0.0
    }

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
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct LoadTorque {
        /// The torque, positive towards positive angles.
        pub torque_nm: f64 = number(-1e6..=1e6).or(0.0),
        /// Begin of the interval.
        pub from_s: f64 = number(0.0..=FOREVER_S).or(0.0),
        /// End of the interval, excluded.
        pub until_s: f64 = number(positive(FOREVER_S)).or(FOREVER_S),
    }
}

impl LoadTorque {
    /// The torque in N m at a time of the run.
    #[must_use]
    pub fn at_nm(&self, time_s: f64) -> f64 {
        if (self.from_s..self.until_s).contains(&time_s) { self.torque_nm } else { 0.0 }
    }

    fn checked(self, section: &mut Section<'_>) -> Self {
        check_times(section, self.from_s, self.until_s);
        self
    }
}

settings! {
    /// `[plant.wear]`: linear growth of the half gap during an interval.
    #[derive(Debug, Clone, PartialEq, Serialize)]
    pub struct Wear {
        /// Total growth.
        pub growth_rad: f64 = number(0.0..=1.0).or(0.0),
        /// Begin of the growth.
        pub from_s: f64 = number(0.0..=FOREVER_S).or(0.0),
        /// End of the growth.
        pub until_s: f64 = number(positive(FOREVER_S)).or(FOREVER_S),
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

    fn checked(self, section: &mut Section<'_>) -> Self {
        check_times(section, self.from_s, self.until_s);
        self
    }
}

/// Far beyond the end of any run.
const FOREVER_S: f64 = 1e6;

/// Checks that an interval ends after its begin.
fn check_times(section: &Section<'_>, from_s: f64, until_s: f64) {
    if until_s <= from_s && section.has("until_s") {
        section.reject("until_s", format!("is not after from_s; it must be > {from_s} s"));
    } else if until_s <= from_s {
        section.reject("from_s", format!("is the end of time; it must be < {until_s} s"));
    }
}
