//! Any bytes are a capture or not, in time and memory that grow with them.

#![no_main]

use lashloop_decode::series::series;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Some(series) = series(bytes) {
        assert!(!series.columns.is_empty());
    }
});
