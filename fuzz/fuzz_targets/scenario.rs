//! Any text is a scenario or is rejected with messages, and a printed scenario reads back as the same scenario.

#![no_main]

use lashloop_bench::scenario::Scenario;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Scenario::from_str("fuzz.toml", text, &[]) {
        Ok(scenario) => {
            let printed = scenario.to_toml().expect("a scenario can be printed");
            let again = Scenario::from_str("fuzz.toml", &printed, &[]).expect("a printed scenario is valid");
            // Compared as text, because scenarios also hold the line numbers of their parameters.
            assert_eq!(again.to_toml().expect("a scenario can be printed"), printed);
        }
        Err(errors) => assert!(!errors.to_string().is_empty()),
    }
});
