//! The halves of the loop.

use lashloop_bench::process_plant;
use lashloop_bench::scenario::fault::FaultKind;
use lashloop_bench::scenario::{RunMode, Scenario};

use crate::error::ExportError;

/// A half of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Plant, encoders, and the line from the drive to the motor.
    Plant,
    /// The firmware with its law, and the reference.
    Drive,
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
            return unfit(
                format!("plant.model = {model:?}"),
                "it runs in a process of its own; an FMU that is the plant is one already, and any other model has to be exported by its own tool",
            );
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
}
