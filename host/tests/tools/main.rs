//! The tools around the line: capture, decode, the Wireshark dissector, doctor.

mod capture;
mod decode;
mod dissector;
mod doctor;
mod support;

/// The messages that protocol version 1 is pinned by.
#[path = "../../../protocol/tests/wire/examples.rs"]
mod examples;
