//! The nominal plant with one quantity varied at a time.

use super::case::Part;
use super::plants::ENCODERS;

pub struct Sweep {
    pub part: Part,
    /// Varied quantity, as in the table.
    pub name: &'static str,
    pub unit: &'static str,
    pub values: &'static [f64],
    /// Keys of the scenario that take the value.
    keys: &'static [&'static str],
}

const fn sweep(
    part: Part,
    name: &'static str,
    unit: &'static str,
    values: &'static [f64],
    keys: &'static [&'static str],
) -> Sweep {
    Sweep { part, name, unit, values, keys }
}

/// The saturation of the motor, and the limit in the drive.
const TORQUE_LIMITS: [&str; 2] = ["plant.torque_saturation_nm", "controller.parameters.torque_limit_nm"];

/// Every sweep, in the order of the tables.
pub const SWEEPS: [Sweep; 7] = [
    sweep(Part::DeadZone, "true j0", "rad", &[0.02, 0.05, 0.1, 0.16, 0.25, 0.4], &["plant.dead_zone_rad"]),
    sweep(Part::EncoderCounts, "encoders", "count/rev", &[1e3, 2e3, 4e3, 1e4, 131_072.0], &ENCODERS),
    sweep(Part::TorqueLimit, "torque limit", "N m", &[2.0, 3.0, 5.0, 10.0, 20.0], &TORQUE_LIMITS),
    sweep(Part::TorqueDelay, "delay", "us", &[0.0, 500.0, 1e3, 2e3, 4e3, 8e3], &["plant.torque_delay_us"]),
    sweep(
        Part::LoadInertia,
        "load inertia",
        "kg m^2",
        &[3.75, 7.5, 11.25, 15.0],
        &["plant.load_inertia_kg_m2"],
    ),
    sweep(
        Part::LoadTorque,
        "lasting load",
        "N m",
        &[-12.0, -6.0, 6.0, 12.0],
        &["plant.load_torque.torque_nm"],
    ),
    sweep(
        Part::TorqueSaturation,
        "unknown saturation",
        "N m",
        &[5.0, 8.0, 10.0, 15.0],
        &["plant.torque_saturation_nm"],
    ),
];

impl Sweep {
    /// A value as `section.key=value`.
    #[must_use]
    pub fn settings(&self, value: f64) -> Vec<String> {
        // Display omits the point of a whole number: counts and microseconds are integers.
        self.keys.iter().map(|key| format!("{key}={value}")).collect()
    }
}
