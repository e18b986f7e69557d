//! What `docs/protocol.md` says a drive does, held against the drive: states, answers, sequences, faults, parameters and
//! the conversation byte by byte.

#[path = "../../../protocol/tests/wire/markdown.rs"]
mod markdown;

mod answers;
mod conversation;
mod links;
mod parameters;
mod sequence;
mod states;
mod talk;
