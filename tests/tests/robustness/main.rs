//! Damaged frames, lossy links, and the seeds of the fuzzers.

#[path = "../../../firmware/tests/properties/action.rs"]
mod action;
mod damaged;
mod damaged_records;
mod fuzz_corpus;
#[allow(dead_code, reason = "the property tests read more of a step")]
#[path = "../../../firmware/tests/properties/invariants.rs"]
mod invariants;
mod lossy;
mod minor_versions;
mod seeds;
#[path = "../../../firmware/tests/properties/transitions.rs"]
mod transitions;
mod undetected_errors;
mod wrong_answers;
