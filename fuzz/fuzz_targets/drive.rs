//! The drive and all it promises, on any history. How bytes become a history stands in `action`.

#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../firmware/tests/properties/action.rs"]
mod action;
#[allow(dead_code, reason = "what a history met is for the property tests")]
#[path = "../../firmware/tests/properties/invariants.rs"]
mod invariants;

fuzz_target!(|input: &[u8]| {
    let mut drive = invariants::Watched::new();
    let mut rest = input;
    while let Some(action) = action::Action::read(&mut rest) {
        drive.act(&action);
    }
});
