//! `docs/protocol.md` against the drive: states, answers, sequences, faults, descriptions, telemetry and the conversation byte by byte; and
//! the links of all documents.

#[path = "../../../protocol/tests/wire/markdown.rs"]
mod markdown;

mod answers;
mod conversation;
mod faults;
mod host;
mod host_rules;
mod links;
mod parameters;
mod rules;
mod script;
mod sequence;
mod states;
mod subscriptions;
mod two_laws;
