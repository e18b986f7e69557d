//! Any text is a campaign file or is rejected with messages.

#![no_main]

use lashloop_campaign::file::CampaignFile;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(errors) = CampaignFile::from_str("fuzz.toml", text) {
        assert!(!errors.to_string().is_empty());
    }
});
