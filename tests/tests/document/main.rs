//! `docs/protocol.md` against the drive: states, answers, sequences, faults, descriptions, telemetry and the conversation byte by byte;
//! `docs/laws.md` against laws and plant; the links of all documents; and the errors of every key of a file of settings.

#[path = "../../../protocol/tests/wire/markdown.rs"]
mod markdown;

mod answers;
mod bench_mode;
mod conversation;
mod faults;
mod host;
mod host_rules;
mod keys;
mod laws;
mod links;
mod parameters;
#[allow(dead_code, reason = "the tests of the firmware use more of it")]
#[path = "../../../firmware/tests/drive/pin_host.rs"]
mod pin_host;
mod rules;
mod script;
mod sequence;
mod states;
mod subscriptions;
mod two_laws;
