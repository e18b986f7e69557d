//! One thing of the nominal plant at a time, from easy to hard.

use super::case::Part;

/// A quantity and the values it takes.
pub struct Sweep {
    /// The table.
    pub part: Part,
    /// What is varied, in words.
    pub name: &'static str,
    /// Unit of the values.
    pub unit: &'static str,
    /// The values.
    pub values: &'static [f64],
    /// The keys of the scenario that take them.
    keys: &'static [&'static str],
}

/// Every sweep, in the order of the tables.
pub const SWEEPS: [Sweep; 4] = [
    Sweep {
        part: Part::DeadZone,
        name: "true j0",
        unit: "rad",
        values: &[0.02, 0.05, 0.1, 0.16, 0.25, 0.4],
        keys: &["plant.dead_zone_rad"],
    },
    Sweep {
        part: Part::EncoderCounts,
        name: "encoders",
        unit: "count/rev",
        values: &[1_000.0, 2_000.0, 4_000.0, 10_000.0, 131_072.0],
        keys: &["encoders.motor_counts_per_rev", "encoders.load_counts_per_rev"],
    },
    Sweep {
        part: Part::TorqueLimit,
        name: "torque limit",
        unit: "N m",
        values: &[2.0, 3.0, 5.0, 10.0, 20.0],
        // What the motor can give and what the drive knows of it.
        keys: &["plant.torque_saturation_nm", "controller.parameters.torque_limit_nm"],
    },
    Sweep {
        part: Part::TorqueDelay,
        name: "delay",
        unit: "us",
        values: &[0.0, 500.0, 1_000.0, 2_000.0, 4_000.0, 8_000.0],
        keys: &["plant.torque_delay_us"],
    },
];

impl Sweep {
    /// A value as `section.key=value`.
    #[must_use]
    pub fn settings(&self, value: f64) -> Vec<String> {
        // Without a point if it is whole: counts and microseconds are whole numbers.
        self.keys.iter().map(|key| format!("{key}={value}")).collect()
    }
}
