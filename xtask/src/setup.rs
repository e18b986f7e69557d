//! Installing what is missing. Nothing asks a question and nothing waits without end.

use std::process::Command;
use std::time::Duration;

use anyhow::{Context, Result};

use crate::arm_toolchain::{ArmToolchain, TARGET};
use crate::{command, python};

/// Programs that the tests call; Debian's packages have the same names.
const PROGRAMS: [&str; 2] = ["qemu-system-arm", "tshark"];

/// rustup waits long for a server it can't reach.
const RUSTUP_LIMIT: Duration = Duration::from_secs(60);

/// Installs the emulator, a reader of captures, a core library for Arm and the Python package, unless they are there.
///
/// # Errors
/// A sentence that says what could not be installed and what to do.
pub(crate) fn install_missing() -> Result<()> {
    let programs = PROGRAMS.map(install_program);
    let python = python::set_up(apt_install);
    install_core()?;
    python?;
    programs.into_iter().collect()
}

fn install_program(name: &str) -> Result<()> {
    if command::find_program(name).is_some() {
        return Ok(());
    }
    apt_install(&[name]).with_context(|| {
        format!("{name} is missing and could not be installed: install it by hand and call again")
    })
}

fn install_core() -> Result<()> {
    if ArmToolchain::find().is_ok() {
        return Ok(());
    }
    if command::find_program("rustup").is_some() {
        let added = command::run_for(Command::new("rustup").args(["target", "add", TARGET]), RUSTUP_LIMIT);
        // rustup may have added it to another compiler than the one in PATH, so its word is not enough.
        if ArmToolchain::find().is_ok() {
            return Ok(());
        }
        if let Err(error) = added {
            eprintln!("setup: {error:#}; trying Debian's compiler");
        }
    }
    if let Err(error) = apt_install(&["rustc-web", "rust-web-src", "rust-web-clippy"]) {
        eprintln!("setup: {error:#}");
    }
    ArmToolchain::find().map(drop)
}

fn apt_install(packages: &[&str]) -> Result<()> {
    command::find_program("apt-get").context("there is no apt-get here")?;
    // The lists of a fresh machine are empty; of one without a network they may still do.
    if let Err(error) = command::run(apt_get().arg("update")) {
        eprintln!("setup: {error:#}; trying with the lists that are here");
    }
    command::run(apt_get().args(["install", "--yes", "--no-install-recommends"]).args(packages))
}

/// `apt-get`, by sudo if need be, without questions and without waiting long for a lock or a server.
fn apt_get() -> Command {
    let is_root = command::first_line(Command::new("id").arg("-u")).is_some_and(|id| id == "0");
    let mut command = if is_root || command::find_program("sudo").is_none() {
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
