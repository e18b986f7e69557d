//! Invariants of the drive under arbitrary histories, in every state.

mod action;
mod histories;
mod invariants;
mod transitions;
