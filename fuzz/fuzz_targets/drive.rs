//! The invariants of the drive hold in any history. `action` converts bytes to a history.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../firmware/tests/properties/action.rs"]
mod action;
#[allow(dead_code, reason = "only the property tests read the coverage of a history")]
#[path = "../../firmware/tests/properties/invariants.rs"]
mod invariants;
#[path = "../../firmware/tests/properties/transitions.rs"]
mod transitions;

fuzz_target!(|input: &[u8]| {
    let mut drive = invariants::CheckedDrive::new();
    let mut rest = input;
    while let Some(action) = action::Action::read(&mut rest) {
        drive.act(&action);
    }
});
