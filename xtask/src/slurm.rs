//! Slurm for the tests of `campaign submit`, from Debian's packages: unpacked into `target/slurm`, not installed, because a
//! machine that runs tests is rarely meant to be a node of a cluster.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::apt;
use crate::command::{command, is_installed, output, run};
use crate::paths;

/// Controller, daemon of a node, commands, and the authentication between them; and the other scheduler of `docs/cluster.md`.
const PACKAGES: [&str; 6] =
    ["slurmctld", "slurmd", "slurm-client", "slurm-wlm-basic-plugins", "munge", "parallel"];
/// One per package that has programs: their libraries must all be there.
const PROGRAMS: [&str; 4] =
    ["usr/sbin/slurmctld-wlm", "usr/sbin/slurmd-wlm", "usr/bin/sbatch", "usr/sbin/munged"];

/// What `setup` prints ahead of the download.
pub(crate) const PLAN: &str =
    "Slurm and GNU parallel, some 6 MB: by apt-get download, unpacked into target/slurm";

/// Whether this machine can run Debian's programs.
pub(crate) fn is_possible() -> bool {
    cfg!(target_os = "linux") && is_installed("apt-get")
}

/// Whether Slurm is there.
pub(crate) fn is_set_up() -> bool {
    stamp().is_file()
}

/// Downloads and unpacks Slurm with the libraries that this machine lacks.
///
/// # Errors
/// What could not be downloaded or started, and what to do.
pub(crate) fn set_up() -> Result<()> {
    let [archives, root] = ["packages", "root"].map(|name| folder().join(name));
    let names = apt::download(&archives, packages)?;
    paths::empty_folder(&root)?;
    for archive in fs::read_dir(&archives)? {
        run(command("dpkg-deb", "--extract").arg(archive?.path()).arg(&root))?;
    }
    fs::remove_dir_all(&archives).context("the packages can't be removed")?;
    let libraries = format!("{0}:{0}/slurm-wlm", library_folder(&root)?.display());
    for program in PROGRAMS {
        let text = output(command("ldd", "").arg(root.join(program)).env("LD_LIBRARY_PATH", &libraries))?;
        let missing: Vec<_> = text.lines().filter(|line| line.contains("not found")).map(str::trim).collect();
        ensure!(missing.is_empty(), "{program} lacks {}", missing.join(", "));
    }
    fs::write(stamp(), names.join("\n")).context("target/slurm can't be written")
}

fn folder() -> PathBuf {
    paths::root().join("target/slurm")
}

/// The file that is written last.
fn stamp() -> PathBuf {
    folder().join("installed")
}

/// `usr/lib/x86_64-linux-gnu` on a PC.
fn library_folder(root: &Path) -> Result<PathBuf> {
    let mut entries = fs::read_dir(root.join("usr/lib"))?.filter_map(|entry| Some(entry.ok()?.path()));
    entries
        .find(|path| path.join("slurm-wlm").is_dir())
        .context("no slurm-wlm in usr/lib of Debian's packages")
}

/// The packages of Slurm, and those that they depend on and this machine lacks.
fn packages() -> Result<Vec<String>> {
    let mut names: Vec<_> = PACKAGES.map(str::to_owned).into();
    let plan = output(command("apt-get", "install --dry-run --no-install-recommends").args(PACKAGES))?;
    names.extend(planned(&plan).map(str::to_owned));
    names.sort_unstable();
    names.dedup();
    Ok(names)
}

fn planned(plan: &str) -> impl Iterator<Item = &str> {
    plan.lines().filter_map(|line| line.strip_prefix("Inst ")?.split(' ').next())
}

#[cfg(test)]
mod tests {
    use super::planned;

    #[test]
    fn what_apt_would_install_is_read_from_its_plan() {
        let plan = "The following NEW packages will be installed:\n  munge slurmd\nInst munge (0.5.15-2 Debian:12.15 \
                    [amd64])\nInst slurmd (22.05.8 Debian:12.15 [amd64])\nConf munge (0.5.15-2 Debian:12.15 [amd64])\n";
        assert_eq!(planned(plan).collect::<Vec<_>>(), ["munge", "slurmd"]);
    }
}
