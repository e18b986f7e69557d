//! The decoder agrees with its specification on any stream in any pieces. The first byte is the length of the pieces.

#![no_main]

use lashloop_protocol::{DriveMessage, HostMessage};
use libfuzzer_sys::fuzz_target;

#[path = "../../protocol/tests/properties/reference.rs"]
mod reference;

fuzz_target!(|input: &[u8]| {
    let Some((&piece_len, stream)) = input.split_first() else { return };
    reference::check::<HostMessage>(stream, &[piece_len.into()]);
    reference::check::<DriveMessage>(stream, &[piece_len.into()]);
});
