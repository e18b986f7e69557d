//! Scenarios that are valid key by key, but hardly what their author meant.
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
mod trap;

use super::error::ScenarioError;
use super::key_error::KeyError;
use super::reader::Section;
use super::tree::Node;

pub use trap::Trap;

pub(super) use facts::Facts;
pub(super) use mismatch::Nominal;

/// Traps that the scenario means, each with the place of its entry.
pub(super) type Meant = Vec<(Trap, Node)>;

/// Reads the key `meant`.
pub(super) fn read_meant(root: &mut Section<'_>) -> Meant {
    let meant = root
        .doc("Traps that are meant. Without its entry, a trap is an error before the run; an entry that the file doesn't need is an error too.")
        .choice_docs(Trap::DOCS.to_vec())
        .choices("meant", &Trap::NAMES);
    for (index, (trap, node)) in meant.iter().enumerate() {
        if meant[..index].iter().any(|(other, _)| other == trap) {
            root.error("meant", node, rejected(node, "is given twice"));
        }
    }
    meant
}

fn rejected(node: &Node, reason: &str) -> KeyError {
    KeyError::Rejected { found: node.value.to_string(), reason: reason.to_owned() }
}

/// Errors of all traps that aren't meant, and of entries of `meant` that silence nothing.
pub(super) fn check(facts: &Facts<'_>, meant: &Meant) -> Vec<ScenarioError> {
    let mut errors = Vec::new();
    let found = [
        (Trap::Start, start::check(facts)),
        (Trap::LargeAngle, angle::check(facts)),
        (Trap::Mismatch, mismatch::check(facts)),
    ];
    for (trap, found) in found {
        let Some((_, entry)) = meant.iter().find(|(other, _)| *other == trap) else {
            errors.extend(found);
            continue;
        };
        // A sweep by options may pass through values that need no entry.
        let is_needed = !found.is_empty() || (trap == Trap::Mismatch && mismatch::depends_on_drive(facts));
        if !is_needed && !facts.is_overridden {
            let error = rejected(entry, "silences nothing: the scenario has no such trap; omit it");
            errors.push(ScenarioError::Key {
                origin: entry.origin.clone(),
                key: "meant".to_owned(),
                error: Box::new(error),
            });
        }
    }
    errors
}
