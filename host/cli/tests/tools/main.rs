//! The tools around line and record: capture, decode, the Wireshark dissector, doctor, the live page, plot.

mod capture;
mod decode;
mod diff;
mod dissector;
mod doctor;
mod export;
mod foreign;
mod link_budget;
mod live;
mod plot;
mod printed;
mod progress;
mod report;
mod rerun;
mod samples;
mod scope;
mod support;

/// The messages that protocol version 1 is pinned by.
#[path = "../../../../protocol/tests/wire/examples.rs"]
mod examples;
