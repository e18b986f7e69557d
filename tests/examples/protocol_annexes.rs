//! Writes the generated parts of the annexes of docs/protocol.md: `cargo run -p tests --example protocol_annexes`.

use std::io;

#[path = "../tests/document/annexes/mod.rs"]
mod annexes;
#[allow(dead_code, reason = "the tests of the protocol use more of it")]
#[path = "../../protocol/tests/wire/data_sheet.rs"]
mod data_sheet;
#[allow(dead_code, reason = "the tests of the protocol use more of it")]
#[path = "../../protocol/tests/wire/examples.rs"]
mod examples;
#[allow(dead_code, reason = "the tests of the document use more of it")]
#[path = "../tests/document/host.rs"]
mod host;

fn main() -> io::Result<()> {
    annexes::ANNEXES.iter().try_for_each(annexes::Annex::write)
}
