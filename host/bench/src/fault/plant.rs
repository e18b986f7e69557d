//! Faults of the plant: gap, shaft and load.

use std::collections::BTreeSet;

use lashloop_plant::{Environment, PlantValues};

use super::schedule::{FaultGroups, Schedule};
use crate::scenario::Scenario;
use crate::scenario::fault::PlantFault;
use crate::scenario::plant::PlantSettings;

/// The faults of the plant.
pub struct PlantFaults(Vec<(Schedule, PlantFault)>);

impl PlantFaults {
    /// The plant faults of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        Self(FaultGroups::of(scenario).plant)
    }

    /// The steps at which faults change the values of the plant's keys, each with the values from then on.
    #[must_use]
    pub fn changes(&self, healthy: &PlantSettings) -> Vec<(u32, PlantValues)> {
        let edges: BTreeSet<_> = self.0.iter().flat_map(|(schedule, _)| schedule.edges()).collect();
        let mut changes = Vec::new();
        let mut before = healthy.values.clone();
        for step in edges {
            let values = self.values(step, healthy);
            if values != before {
                changes.push((step, values.clone()));
                before = values;
            }
        }
        changes
    }

    /// The values of the plant's keys in a step.
    #[must_use]
    pub fn values(&self, step: u32, healthy: &PlantSettings) -> PlantValues {
        let mut values = healthy.values.clone();
        let changes = healthy.model.changes();
        for fault in self.active(step) {
            let (keys, factor) = match *fault {
                PlantFault::GapGrowth { .. } | PlantFault::LoadTorque { .. } => continue,
                PlantFault::StiffnessDrop { factor } => (changes.stiffness, factor),
                PlantFault::FrictionChange { factor } => (changes.friction, factor),
            };
            for key in keys {
                values.scale(key, factor);
            }
        }
        values
    }

    /// Growth of the gap and load torque in a step, in addition to those of the scenario.
    #[must_use]
    pub fn environment(&self, step: u32) -> Environment {
        let mut environment = Environment::default();
        for fault in self.active(step) {
            match *fault {
                PlantFault::GapGrowth { growth_rad } => environment.gap_growth_rad += growth_rad,
                PlantFault::LoadTorque { torque_nm } => environment.load_torque_nm += torque_nm,
                PlantFault::StiffnessDrop { .. } | PlantFault::FrictionChange { .. } => {}
            }
        }
        environment
    }

    fn active(&self, step: u32) -> impl Iterator<Item = &PlantFault> {
        self.0.iter().filter(move |(schedule, _)| schedule.contains(step)).map(|(_, fault)| fault)
    }
}
