//! Faults of the plant.

use lashloop_plant::PlantModel;
use serde::Serialize;

use crate::scenario::declare::number;
use crate::scenario::range::positive;
use crate::settings;

settings! {
    /// Changes of gap, shaft and load, on plants that take them.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
    #[serde(tag = "kind")]
    pub enum PlantFault {
        /// The gap widens.
        "gap-growth" => GapGrowth {
            /// Growth of the half width, at the motor.
            growth_rad: f64 = number(positive(3.0)),
        },
        /// The shaft's stiffness changes.
        "stiffness-drop" => StiffnessDrop {
            /// New stiffness over the old one.
            factor: f64 = number(positive(100.0)),
        },
        /// An external torque acts on the load.
        "load-torque" => LoadTorque {
            /// The torque, positive towards positive angles.
            torque_nm: f64 = number(-1e6..=1e6),
        },
        /// The load's dry friction changes.
        "friction-change" => FrictionChange {
            /// New Coulomb and stiction torque over the old ones.
            factor: f64 = number(positive(100.0)),
        },
    }
}

impl PlantFault {
    /// Whether the plants of a model take this change.
    pub(super) fn is_taken_by(&self, model: &PlantModel) -> bool {
        let changes = model.changes();
        match self {
            Self::GapGrowth { .. } | Self::LoadTorque { .. } => changes.environment,
            Self::StiffnessDrop { .. } => !changes.stiffness.is_empty(),
            Self::FrictionChange { .. } => !changes.friction.is_empty(),
        }
    }
}
