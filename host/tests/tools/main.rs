//! The tools around line and record: capture, decode, the Wireshark dissector, doctor, plot.

mod capture;
mod decode;
mod diff;
mod dissector;
mod doctor;
mod plot;
mod rerun;
mod support;

/// The messages that protocol version 1 is pinned by.
#[path = "../../../protocol/tests/wire/examples.rs"]
mod examples;
