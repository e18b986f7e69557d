//! Scenarios that are valid key by key, but probably not what their author meant.
//!
//! A trap is an error before the run. The top-level key `meant` names the traps that are meant:
//!
//! | `meant` | silences |
//! |---|---|
//! | `start` | an initial state that doesn't fit the gap, or the first value of the reference |
//! | `mismatch` | a plant whose ratio, gap or inertia differs from the drive's parameters |
//! | `large-angle` | an angle of more than two turns |
//!
//! Plant and reference are compared by the names of their keys. A plant of one's own takes part as far as it uses these keys.

mod angle;
mod facts;
mod mismatch;
mod start;

use super::declare::Named;
use super::error::ScenarioError;
use super::key_error::KeyError;
use super::reader::Section;
use super::tree::Node;
use crate::settings;

pub(super) use facts::Facts;
pub(super) use mismatch::Nominal;

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

/// Reports entries of `meant` that repeat others.
pub(super) fn check_meant(meant: Vec<Trap>, root: &mut Section<'_>) -> Vec<Trap> {
    let entries = root.node("meant").map_or(&[][..], Node::items);
    // A faulty entry has its own error.
    if entries.len() == meant.len() {
        for (index, (trap, entry)) in meant.iter().zip(entries).enumerate() {
            if meant[..index].contains(trap) {
                root.error("meant", entry, KeyError::rejected(&entry.value, "is given twice"));
            }
        }
    }
    meant
}

/// Errors of all traps that aren't meant, and of entries of `meant` that silence nothing.
pub(super) fn check(facts: &Facts<'_>, meant: &[Trap]) -> Vec<ScenarioError> {
    let mut errors = Vec::new();
    let found = [
        (Trap::Start, start::check(facts)),
        (Trap::LargeAngle, angle::check(facts)),
        (Trap::Mismatch, mismatch::check(facts)),
    ];
    for (trap, found) in found {
        let entries = facts.tree.get("meant").map_or(&[][..], Node::items);
        let Some((_, entry)) = meant.iter().zip(entries).find(|(other, _)| **other == trap) else {
            errors.extend(found);
            continue;
        };
        // A sweep by options may pass through values that need no entry.
        let is_needed = !found.is_empty() || (trap == Trap::Mismatch && mismatch::depends_on_drive(facts));
        if !is_needed && !facts.is_overridden {
            let reason = "silences nothing: the scenario has no such trap; omit it";
            errors.push(ScenarioError::rejected(&entry.origin, "meant", &entry.value, reason));
        }
    }
    errors
}
