//! The halves of the loop, and their variables.

use std::ops::Range;

use lashloop_bench::process_plant;
use lashloop_bench::scenario::fault::FaultKind;
use lashloop_bench::scenario::{RunMode, Scenario};

use crate::drive::Drive;
use crate::error::ExportError;
use crate::plant::PlantSide;
use crate::source::Source;
use crate::variable::{Role, Value, Variable};

/// A half of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Plant, encoders, and the line from the drive to the motor.
    Plant,
    /// The firmware with its law, and the reference.
    Drive,
}

/// The variables of an FMU and what it can do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Interface {
    /// Time, inputs, outputs, parameters.
    pub(crate) variables: Vec<Variable>,
    pub(crate) inputs: Range<usize>,
    pub(crate) outputs: Range<usize>,
    /// Whether it takes steps that aren't multiples of the control period.
    pub(crate) takes_any_step: bool,
    pub(crate) can_be_saved: bool,
}

impl Interface {
    pub(crate) fn new(inputs: Vec<Variable>, outputs: Vec<Variable>, parameters: Vec<Variable>) -> Self {
        let time = Variable::new(Role::Time, "time", "s", Value::Real(0.0), "Time of the simulation");
        let inputs_end = 1 + inputs.len();
        let outputs_end = inputs_end + outputs.len();
        Self {
            variables: [time].into_iter().chain(inputs).chain(outputs).chain(parameters).collect(),
            inputs: 1..inputs_end,
            outputs: inputs_end..outputs_end,
            takes_any_step: false,
            can_be_saved: false,
        }
    }
}

impl Part {
    /// `plant` or `drive`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plant => "plant",
            Self::Drive => "drive",
        }
    }

    /// The part of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::Plant, Self::Drive].into_iter().find(|part| part.name() == name)
    }

    pub(crate) const fn summary(self) -> &'static str {
        match self {
            Self::Plant => "Plant, encoders and line to the motor",
            Self::Drive => "Drive with its reference",
        }
    }

    /// Name of the library in the FMU.
    pub(crate) const fn identifier(self) -> &'static str {
        match self {
            Self::Plant => "lashloop_plant",
            Self::Drive => "lashloop_drive",
        }
    }

    /// What the scenario has and the FMU can't have.
    pub(crate) fn check(self, scenario: &Scenario) -> Result<(), ExportError> {
        let unfit = |what: String, reason| Err(ExportError::Unfit { what, part: self.name(), reason });
        if scenario.run.mode == RunMode::Bench {
            return unfit(
                "run.mode = \"bench\"".to_owned(),
                "the drive reads its own pins; take run.mode = \"hil\"",
            );
        }
        let model = scenario.plant.model.name();
        if self == Self::Plant && process_plant::is_process(model) {
            return unfit(format!("plant.model = {model:?}"), "it runs in a process of its own");
        }
        let strikes_drive = |kind: &FaultKind| {
            matches!(kind, FaultKind::Frame { .. } | FaultKind::Link(_) | FaultKind::Device(_))
        };
        let fault = scenario.faults.iter().find(|fault| strikes_drive(&fault.kind));
        match fault {
            Some(fault) if self == Self::Drive => {
                let reason = "it strikes the line or the device, which the FMU doesn't have; leave it out";
                unfit(format!("the fault {:?}", fault.kind.name()), reason)
            }
            _ => Ok(()),
        }
    }

    /// The variables for a scenario.
    pub(crate) fn interface(self, source: &Source) -> Result<Interface, ExportError> {
        match self {
            Self::Plant => PlantSide::interface(source),
            Self::Drive => Drive::interface(source),
        }
    }
}
