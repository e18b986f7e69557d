//! Any text is a scenario or is refused with messages.

#![no_main]

use lashloop::scenario::Scenario;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Scenario::from_str("fuzz.toml", text, &[]) {
        Ok(scenario) => drop(scenario.to_toml()),
        Err(errors) => assert!(!errors.to_string().is_empty()),
    }
});
