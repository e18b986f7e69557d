//! Invariants of the drive under arbitrary histories, in every state.

mod action;
mod coverage;
mod histories;
#[allow(dead_code, reason = "the replay of the fuzzer's corpus reads more of a step")]
mod invariants;
mod transitions;
