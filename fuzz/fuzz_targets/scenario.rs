//! Any text is a scenario or is refused with messages.

#![no_main]

use lashloop::scenario::Scenario;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Scenario::from_str("fuzz.toml", text, &[]) {
        Ok(scenario) => {
            let spelled_out = scenario.to_toml();
            if let Ok(toml) = spelled_out {
                let again = Scenario::from_str("fuzz.toml", &toml, &[]);
                assert_eq!(again.as_ref().ok(), Some(&scenario), "{toml}");
            }
        }
        Err(errors) => assert!(!errors.to_string().is_empty()),
    }
});
