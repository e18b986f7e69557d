//! The Python package's interpreter, and its drive on a pseudo-terminal.

use std::path::PathBuf;
use std::process::Command;

use crate::twin::Twin;
use crate::workspace;

/// The interpreter into which `cargo xtask setup` installs the package.
#[must_use]
pub fn interpreter() -> PathBuf {
    workspace().join("target/python/bin/python")
}

/// Names missing equipment and the command that installs it.
#[must_use]
pub fn missing() -> Option<String> {
    let python = interpreter();
    (!python.is_file())
        .then(|| format!("no Python with the package at {}: run `cargo xtask setup`", python.display()))
}

/// `python -m lashloop drive`.
#[must_use]
pub fn drive() -> Twin {
    let mut command = Command::new(interpreter());
    command.args(["-m", "lashloop", "drive"]);
    Twin::serving(command)
}

/// The device that starts Python with these arguments, a drive on its standard input and output.
#[must_use]
pub fn on_standard_streams(arguments: &str) -> String {
    format!("exec:{} {arguments}", interpreter().display())
}
