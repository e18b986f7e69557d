//! The traps and their names.

use serde::Serialize;

use crate::scenario::key::Choice;

/// Something that is hardly meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trap {
    /// The initial state doesn't fit the gap or the reference.
    Start,
    /// The plant isn't the one that the drive's parameters describe.
    Mismatch,
    /// An angle is beyond two turns.
    LargeAngle,
}

impl Trap {
    pub(super) const NAMES: [(&'static str, Self); 3] =
        [("start", Self::Start), ("mismatch", Self::Mismatch), ("large-angle", Self::LargeAngle)];

    pub(super) const DOCS: [Choice; 3] = [
        Choice {
            name: "start",
            doc: "The load starts away from the first value of a reference that moves, or the twist starts beyond the gap.",
        },
        Choice {
            name: "mismatch",
            doc: "Ratio, gap or inertia of the plant differ from the drive's parameters of the same name.",
        },
        Choice {
            name: "large-angle",
            doc: "An initial position or an angle of the reference is beyond two turns.",
        },
    ];

    /// What an error adds to the remedy.
    pub(super) fn silenced(self) -> String {
        let (name, _) = Self::NAMES.into_iter().find(|(_, trap)| *trap == self).unwrap_or(Self::NAMES[0]);
        format!("or write meant = [\"{name}\"] at the top of the scenario")
    }
}
