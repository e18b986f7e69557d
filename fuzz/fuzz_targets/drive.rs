//! The drive and all it promises, on any history. How bytes become a history stands in `action`.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../firmware/tests/properties/action.rs"]
mod action;
#[allow(dead_code, reason = "only the property tests observe the steps of a drive")]
#[path = "../../firmware/tests/properties/invariants.rs"]
mod invariants;
#[path = "../../firmware/tests/properties/transitions.rs"]
mod transitions;

fuzz_target!(|input: &[u8]| {
    let mut drive = invariants::CheckedDrive::<()>::new();
    let mut rest = input;
    while let Some(action) = action::Action::read(&mut rest) {
        drive.act(&action);
    }
});
