//! What may be in the dependency tree: `deny.toml`, judged by cargo-deny.

use anyhow::{Context, Result};

use crate::command::{cargo, command, first_line, run};
use crate::paths;

const VERSION: &str = "0.20.2";

/// Checks licences, sources, and crates in two versions. An exception that nothing needs is an error too.
///
/// # Errors
/// A rule is broken, or cargo-deny can't be had.
pub(crate) fn check() -> Result<()> {
    let tools = paths::root().join("target/tools");
    let program = tools.join("bin/cargo-deny");
    if first_line(&mut command(&program, "--version")).is_none_or(|line| !line.ends_with(VERSION)) {
        println!("check: compiles cargo-deny {VERSION} into {}", tools.display());
        // Compiling takes longer than a check, so nothing is optimised.
        let install = format!("install cargo-deny --version ={VERSION} --locked --debug --quiet --root");
        run(cargo(&install).arg(&tools)).context("cargo-deny can't be compiled: is there a network?")?;
    }
    run(&mut command(&program, "check --deny warnings licenses bans sources"))
}
