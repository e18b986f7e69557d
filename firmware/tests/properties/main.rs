//! What the drive never does, whatever it is told in whatever state.

mod action;
mod histories;
mod invariants;
