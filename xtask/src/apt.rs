//! Debian's package manager, as root, without questions and without a long wait for a lock or a server.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::command::{command, first_line, is_installed, run};
use crate::paths;

/// Installs the packages; nothing to do for none.
///
/// # Errors
/// `apt-get` is missing, or it failed.
pub(crate) fn install(packages: &[&str]) -> Result<()> {
    if packages.is_empty() {
        return Ok(());
    }
    let needed = || format!("{} could not be installed", packages.join(", "));
    ensure!(is_installed("apt-get"), "{}: apt-get is missing", needed());
    // The lists of a fresh machine are empty; without a network old lists may still do.
    if let Err(error) = update() {
        println!("setup: {error:#}; trying with the package lists of this machine");
    }
    run(apt_get("install --yes --no-install-recommends").args(packages)).with_context(needed)
}

/// Updates the lists of packages.
///
/// # Errors
/// `apt-get` failed.
pub(crate) fn update() -> Result<()> {
    run(&mut apt_get("update"))
}

/// Downloads packages into an empty folder, without installing them.
///
/// # Errors
/// The folder can't be made, `packages` does not know their names, or `apt-get` failed.
pub(crate) fn download(folder: &Path, packages: impl Fn() -> Result<Vec<String>>) -> Result<Vec<String>> {
    // The lists of a fresh machine are empty.
    let names = packages().or_else(|_| update().and_then(|()| packages()))?;
    paths::empty_folder(folder)?;
    let mut download =
        command("apt-get", "--quiet --option Acquire::Retries=1 --option Acquire::http::Timeout=30");
    // An unprivileged helper of apt may not write into the folder of the project.
    download.args(["--option", "APT::Sandbox::User=root", "download"]).args(&names).current_dir(folder);
    run(&mut download)
        .with_context(|| format!("{} could not be downloaded: is there a network?", names.join(", ")))?;
    Ok(names)
}

pub(crate) fn is_root() -> bool {
    first_line(&mut command("id", "-u")).is_some_and(|id| id == "0")
}

fn apt_get(chore: &str) -> Command {
    let is_direct = is_root() || !is_installed("sudo");
    let (program, sudo_arguments) = if is_direct { ("env", "") } else { ("sudo", "--non-interactive env") };
    let arguments = format!(
        "{sudo_arguments} DEBIAN_FRONTEND=noninteractive apt-get --quiet --option DPkg::Lock::Timeout=120 \
         --option Acquire::Retries=1 --option Acquire::http::Timeout=30 {chore}"
    );
    command(program, &arguments)
}
