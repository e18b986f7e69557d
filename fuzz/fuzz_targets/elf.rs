//! Any bytes are an image for a board or an error.

#![no_main]

use std::path::Path;

use lashloop_hardware::flash::Image;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match Image::from_bytes(Path::new("fuzz.elf"), bytes) {
        Ok(image) => assert!(!image.bytes.is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
