//! Any text is a scenario or is refused with messages, and a scenario that is printed reads back as itself.

#![no_main]

use lashloop_bench::scenario::Scenario;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Scenario::from_str("fuzz.toml", text, &[]) {
        Ok(scenario) => {
            let printed = scenario.to_toml().expect("what was read can be printed");
            let again = Scenario::from_str("fuzz.toml", &printed, &[]).expect("what was printed can be read");
            // Compared as printed: the scenarios themselves also know the lines their parameters stood on.
            assert_eq!(again.to_toml().expect("as before"), printed);
        }
        Err(errors) => assert!(!errors.to_string().is_empty()),
    }
});
