//! Debian's package manager, as root, without questions and without a long wait for a lock or a server.

use std::process::Command;

use anyhow::{Context, Result};

use crate::command;

/// Installs the packages; nothing to do for none.
///
/// # Errors
/// There is no `apt-get`, or it failed.
pub(crate) fn install(packages: &[&str]) -> Result<()> {
    if packages.is_empty() {
        return Ok(());
    }
    let needed = || format!("{} could not be installed", packages.join(", "));
    command::find_program("apt-get").context("there is no apt-get here").with_context(needed)?;
    // The lists of a fresh machine are empty; without a network old lists may still do.
    if let Err(error) = command::run(apt_get().arg("update")) {
        println!("setup: {error:#}; trying with the lists that are here");
    }
    command::run(apt_get().args(["install", "--yes", "--no-install-recommends"]).args(packages))
        .with_context(needed)
}

pub(crate) fn is_root() -> bool {
    command::first_line(Command::new("id").arg("-u")).is_some_and(|id| id == "0")
}

fn apt_get() -> Command {
    let mut command = if is_root() || command::find_program("sudo").is_none() {
        Command::new("env")
    } else {
        let mut sudo = Command::new("sudo");
        sudo.args(["--non-interactive", "env"]);
        sudo
    };
    command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get", "--quiet"]);
    for option in ["DPkg::Lock::Timeout=120", "Acquire::Retries=1", "Acquire::http::Timeout=30"] {
        command.args(["--option", option]);
    }
    command
}
