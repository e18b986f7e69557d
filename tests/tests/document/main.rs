//! `docs/protocol.md` and its annexes against the drive: states, answers, sequences, faults, descriptions, telemetry and the
//! conversation byte by byte; `docs/laws.md` against laws and plant; the links of all documents; and the errors of every key of a
//! file of settings.

#[allow(dead_code, reason = "the tests of the protocol use more of it")]
#[path = "../../../protocol/tests/wire/data_sheet.rs"]
mod data_sheet;
#[allow(dead_code, reason = "the tests of the protocol use more of it")]
#[path = "../../../protocol/tests/wire/examples.rs"]
mod examples;
#[path = "../../../protocol/tests/wire/markdown.rs"]
mod markdown;

mod alterations;
mod annexes;
mod answers;
mod bench_mode;
mod conversation;
mod faults;
mod host;
mod host_rules;
mod keys;
mod laws;
#[allow(dead_code, reason = "the tests of the firmware use more of it")]
#[path = "../../../firmware/tests/drive/line.rs"]
mod line;
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
