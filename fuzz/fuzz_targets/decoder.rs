//! The decoder agrees with its specification on any stream in any pieces.
//!
//! The low seven bits of the first byte are the length of the pieces; with the highest bit the stream is one for the host.

#![no_main]

use lashloop_protocol::{DriveMessage, HostMessage};
use libfuzzer_sys::fuzz_target;

mod oracle;

fuzz_target!(|input: &[u8]| {
    let Some((&first, stream)) = input.split_first() else { return };
    let piece_len = usize::from(first & 0x7f);
    if first & 0x80 == 0 {
        oracle::check::<HostMessage>(stream, piece_len);
    } else {
        oracle::check::<DriveMessage>(stream, piece_len);
    }
});
