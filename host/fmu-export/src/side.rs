//! The plant or the drive in an instance, behind one set of calls.

use lashloop_bench::scenario::Scenario;

use crate::drive::Drive;
use crate::error::ExportError;
use crate::interface::Interface;
use crate::part::Part;
use crate::plant::{PlantSide, PlantState};
use crate::source::Source;
use crate::variable::Value;

/// What an instance advances.
pub(crate) enum Side {
    Plant(Box<PlantSide>),
    Drive(Box<Drive>),
}

impl Side {
    /// The variables of the FMU of a scenario.
    pub(crate) fn interface(source: &Source) -> Result<Interface, ExportError> {
        match source.part {
            Part::Plant => PlantSide::interface(source),
            Part::Drive => Drive::interface(source),
        }
    }

    /// This part of a scenario at its start.
    pub(crate) fn new(part: Part, scenario: &Scenario, is_external: bool) -> Result<Self, ExportError> {
        Ok(match part {
            Part::Plant => Self::Plant(Box::new(PlantSide::new(scenario)?)),
            Part::Drive => Self::Drive(Box::new(Drive::new(scenario.clone(), is_external)?)),
        })
    }

    /// Advances with these inputs until this time.
    pub(crate) fn advance(&mut self, inputs: &[Value], until_ns: u64) -> Result<(), ExportError> {
        match self {
            Self::Plant(plant) => plant.advance(inputs.first().map_or(0.0, Value::real), until_ns),
            Self::Drive(drive) => drive.advance(inputs, until_ns),
        }
    }

    /// Writes the outputs, in the order of the interface.
    pub(crate) fn outputs(&self, outputs: &mut [Value]) {
        match self {
            Self::Plant(plant) => plant.outputs(outputs),
            Self::Drive(drive) => drive.outputs(outputs),
        }
    }

    /// The state; `None` if it can't be saved.
    pub(crate) fn save(&self) -> Option<PlantState> {
        if let Self::Plant(plant) = self { plant.save() } else { None }
    }
}
