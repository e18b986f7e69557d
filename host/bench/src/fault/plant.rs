//! Faults of the gears: the plant, and what is around it, at a step.

use std::collections::BTreeSet;

use super::{Schedule, at_place};
use crate::scenario::Scenario;
use crate::scenario::fault::{FaultKind, Place};
use crate::scenario::plant::PlantSettings;

/// The faults of the plant.
pub struct GearFaults(Vec<(Schedule, FaultKind)>);

impl GearFaults {
    /// Those of a scenario.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        Self(at_place(scenario, Place::Plant).map(|(_, schedule, kind)| (schedule, kind)).collect())
    }

    fn active(&self, step: u32) -> impl Iterator<Item = &FaultKind> {
        self.0.iter().filter(move |(schedule, _)| schedule.contains(step)).map(|(_, kind)| kind)
    }

    /// By how much half the gap is wider.
    #[must_use]
    pub fn growth_rad(&self, step: u32) -> f64 {
        let growth = self.active(step).map(|kind| match kind {
            FaultKind::GapGrowth { growth_rad } => *growth_rad,
            _ => 0.0,
        });
        growth.sum()
    }

    /// The torque on the load.
    #[must_use]
    pub fn load_torque_nm(&self, step: u32) -> f64 {
        let torque = self.active(step).map(|kind| match kind {
            FaultKind::LoadTorque { torque_nm } => *torque_nm,
            _ => 0.0,
        });
        torque.sum()
    }

    /// The steps from which on the plant itself is another one, in their order.
    #[must_use]
    pub fn changes(&self) -> BTreeSet<u32> {
        let changing = self.0.iter().filter(|(_, kind)| {
            matches!(kind, FaultKind::StiffnessDrop { .. } | FaultKind::FrictionChange { .. })
        });
        changing.flat_map(|(schedule, _)| [schedule.from, schedule.until]).collect()
    }

    /// The plant as it is in a step.
    #[must_use]
    pub fn settings(&self, step: u32, healthy: &PlantSettings) -> PlantSettings {
        let mut settings = healthy.clone();
        for kind in self.active(step) {
            match (kind, &mut settings.backlash_shaft) {
                (FaultKind::StiffnessDrop { factor }, _) => settings.stiffness_nm_rad *= factor,
                (FaultKind::FrictionChange { factor }, Some(bench)) => {
                    bench.load_coulomb_nm *= factor;
                    bench.load_stiction_nm *= factor;
                }
                _ => {}
            }
        }
        settings
    }
}
