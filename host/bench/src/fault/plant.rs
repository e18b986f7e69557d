//! Faults of the plant: gap, shaft and load.

use std::collections::BTreeSet;

use super::schedule::{FaultGroups, Schedule};
use crate::scenario::Scenario;
use crate::scenario::fault::PlantFault;
use crate::scenario::plant::PlantSettings;

/// The faults of the plant.
pub struct PlantFaults(Vec<(Schedule, PlantFault)>);

/// The plant as the active faults leave it.
#[derive(Debug, Clone, PartialEq)]
pub struct FaultyPlant {
    /// Parameters of the plant.
    pub settings: PlantSettings,
    /// Growth of the gap's half width, rad.
    pub growth_rad: f64,
    /// External torque on the load, N m.
    pub load_torque_nm: f64,
}

impl PlantFaults {
    /// The plant faults of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        Self(FaultGroups::of(scenario).plant)
    }

    /// The steps at which faults change the plant's parameters, each with the parameters from then on.
    #[must_use]
    pub fn changes(&self, healthy: &PlantSettings) -> Vec<(u32, PlantSettings)> {
        let edges: BTreeSet<_> = self.0.iter().flat_map(|(schedule, _)| schedule.edges()).collect();
        let mut changes = Vec::new();
        let mut before = healthy.clone();
        for step in edges {
            let settings = self.at(step, healthy).settings;
            if settings != before {
                changes.push((step, settings.clone()));
                before = settings;
            }
        }
        changes
    }

    /// The plant in a step.
    #[must_use]
    pub fn at(&self, step: u32, healthy: &PlantSettings) -> FaultyPlant {
        let mut plant = FaultyPlant { settings: healthy.clone(), growth_rad: 0.0, load_torque_nm: 0.0 };
        for (_, fault) in self.0.iter().filter(|(schedule, _)| schedule.contains(step)) {
            match *fault {
                PlantFault::GapGrowth { growth_rad } => plant.growth_rad += growth_rad,
                PlantFault::LoadTorque { torque_nm } => plant.load_torque_nm += torque_nm,
                PlantFault::StiffnessDrop { factor } => plant.settings.stiffness_nm_rad *= factor,
                PlantFault::FrictionChange { factor } => {
                    // The reader rejects this fault on every other plant.
                    if let Some(shaft) = &mut plant.settings.backlash_shaft {
                        shaft.load_coulomb_nm *= factor;
                        shaft.load_stiction_nm *= factor;
                    }
                }
            }
        }
        plant
    }
}
