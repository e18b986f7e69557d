//! Writes the golden trace of the profile `pd`: `cargo run -p tests --example pd_trace`.

use std::{fs, io};

#[allow(dead_code, reason = "the test compares, the example writes")]
#[path = "../tests/reference/pd_trace.rs"]
mod pd_trace;

fn main() -> io::Result<()> {
    fs::write(pd_trace::path(), pd_trace::text())
}
