//! Why a request was refused, as its answer says it.

use lashloop_protocol::enums::Outcome;

/// A refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) outcome: Outcome,
    /// What the outcome says more; 0 for most.
    pub(super) detail: u32,
}

impl From<Outcome> for Refusal {
    fn from(outcome: Outcome) -> Self {
        Self { outcome, detail: 0 }
    }
}

impl Refusal {
    /// Outcome and detail of an answer.
    pub(super) fn of(result: Result<(), Self>) -> Self {
        result.err().unwrap_or(Self { outcome: Outcome::Accepted, detail: 0 })
    }
}
