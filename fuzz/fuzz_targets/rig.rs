//! Any text is a rig file or is rejected with messages.

#![no_main]

use lashloop::rig::Rig;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(errors) = Rig::from_str("fuzz.toml", text) {
        assert!(!errors.to_string().is_empty());
    }
});
