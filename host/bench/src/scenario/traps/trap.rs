//! The traps and their names.

use crate::scenario::declare::Named;
use crate::settings;

settings! {
    /// A likely mistake: valid key by key, but probably unintended.
    pub enum Trap {
        /// The load starts away from the first value of a reference that moves, or the twist starts beyond the gap.
        "start" => Start,
        /// Ratio, gap or inertia of the plant differ from the drive's parameters of the same name.
        "mismatch" => Mismatch,
        /// An initial position or an angle of the reference is beyond two turns.
        "large-angle" => LargeAngle,
    }
}

impl Trap {
    /// What an error adds to the remedy.
    pub(super) fn silenced(self) -> String {
        format!("or write meant = [\"{}\"] at the top of the scenario", self.choice().name)
    }
}
