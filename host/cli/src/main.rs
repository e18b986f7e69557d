//! The `lashloop` program: the bench with Lashloop's own laws and plants.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    lashloop_cli::main(&lashloop::Bench::new())
}
