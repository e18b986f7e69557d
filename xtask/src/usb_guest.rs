//! The parts of the Linux guest for tests of USB: a kernel with its drivers, and udev, from Debian's packages. They are
//! unpacked into `target/usb-guest` and not installed.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context, Result};

use crate::apt;
use crate::command::{command, is_installed, output, run};
use crate::paths;

/// Debian's name for its latest kernel. The flavour for clouds has no USB.
const KERNEL: &str = "linux-image-amd64";
const UDEV: &str = "udev";
/// The emulator, and the Debian package that has it.
pub(crate) const EMULATOR: (&str, &str) = ("qemu-system-x86_64", "qemu-system-x86");

/// Files of the kernel's package that the guest may need.
const KERNEL_FILES: [&str; 8] = [
    "./boot/vmlinuz-*",
    "./lib/modules/*/modules.builtin",
    "./lib/modules/*/kernel/drivers/usb/*",
    "./lib/modules/*/kernel/drivers/virtio/*",
    "./lib/modules/*/kernel/drivers/char/virtio_console.ko*",
    "./lib/modules/*/kernel/net/9p/*",
    "./lib/modules/*/kernel/fs/9p/*",
    "./lib/modules/*/kernel/fs/*cache/*",
];
/// Where a kernel has the common part of network file systems, if it has one.
const OPTIONAL_KERNEL_FILES: [&str; 1] = ["./lib/modules/*/kernel/fs/netfs/*"];
const UDEV_FILES: [&str; 2] = ["./bin/udevadm", "./lib/udev/rules.d/*"];

/// What `setup` prints ahead of the download.
pub(crate) const PLAN: &str =
    "a Linux kernel and udev for a guest, some 75 MB: by apt-get download, unpacked into target/usb-guest";

/// Whether a guest can run on this machine at all: its programs are those of this machine.
pub(crate) fn is_possible() -> bool {
    cfg!(all(target_os = "linux", target_arch = "x86_64")) && is_installed("apt-get")
}

/// Whether the parts are there.
pub(crate) fn is_set_up() -> bool {
    stamp().is_file()
}

/// Downloads and unpacks the parts.
///
/// # Errors
/// What could not be downloaded, and what to do.
pub(crate) fn set_up() -> Result<()> {
    let [packages, root] = ["packages", "root"].map(|name| folder().join(name));
    let names = apt::download(&packages, || Ok(vec![kernel_package()?, UDEV.to_owned()]))?;
    paths::empty_folder(&root)?;
    unpack(&package(&packages, "linux-image-")?, &KERNEL_FILES, &root)?;
    let _ = unpack(&package(&packages, "linux-image-")?, &OPTIONAL_KERNEL_FILES, &root);
    unpack(&package(&packages, "udev_")?, &UDEV_FILES, &root)?;
    fs::remove_dir_all(&packages).context("the packages can't be removed")?;
    fs::write(stamp(), names.join("\n")).context("target/usb-guest can't be written")
}

fn folder() -> PathBuf {
    paths::root().join("target/usb-guest")
}

/// The file that is written last.
fn stamp() -> PathBuf {
    folder().join("installed")
}

/// The package of the kernel that the name stands for today.
fn kernel_package() -> Result<String> {
    let text = output(&mut command("apt-cache", &format!("depends {KERNEL}")))?;
    kernel_in(&text)
        .map(str::to_owned)
        .with_context(|| format!("no kernel among the dependencies of {KERNEL}"))
}

fn kernel_in(dependencies: &str) -> Option<&str> {
    let mut names = dependencies.lines().filter_map(|line| line.trim().strip_prefix("Depends: "));
    names.find(|name| name.starts_with("linux-image-") && !name.contains('<'))
}

fn package(folder: &Path, prefix: &str) -> Result<PathBuf> {
    let mut entries = fs::read_dir(folder)?.filter_map(|entry| Some(entry.ok()?.path()));
    let is_wanted =
        |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(prefix));
    entries.find(is_wanted).with_context(|| format!("apt-get downloaded no {prefix}*.deb"))
}

/// Unpacks the files of a package that match the patterns.
fn unpack(package: &Path, patterns: &[&str], root: &Path) -> Result<()> {
    let archive = root.with_extension("tar");
    let mut extract = command("dpkg-deb", "--fsys-tarfile");
    run(extract.arg(package).stdout(Stdio::from(File::create(&archive)?)))?;
    let mut tar = command("tar", "--extract --wildcards --no-same-owner --file");
    let unpacked = run(tar.arg(&archive).arg("--directory").arg(root).args(patterns));
    fs::remove_file(&archive)?;
    unpacked
}

#[cfg(test)]
mod tests {
    use super::kernel_in;

    #[test]
    fn the_kernel_is_the_package_and_not_a_virtual_one() {
        let text = "linux-image-amd64\n  Depends: linux-image-6.1.0-40-amd64\n    linux-image-6.1.0-40-amd64-unsigned\n";
        assert_eq!(kernel_in(text), Some("linux-image-6.1.0-40-amd64"));
        assert_eq!(kernel_in("linux-image-amd64\n"), None);
    }
}
