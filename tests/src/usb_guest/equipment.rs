//! What the guest is made of: kernel and udev as `cargo xtask setup` unpacks them from Debian's packages, programs of this
//! workspace, and the shared libraries of this machine that these need.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use lashloop_bench::supervisor::find_program;

use super::{cpio::Archive, modules};
use crate::{rom_loader, workspace};

/// The emulator of a PC.
pub const EMULATOR: &str = "qemu-system-x86_64";

/// Rules of udev that name serial ports.
const RULES: [&str; 2] = ["50-udev-default.rules", "60-serial.rules"];

/// The kernel and the first file system of a guest.
pub struct Equipment {
    /// The kernel.
    pub kernel: PathBuf,
    /// The archive that the kernel unpacks.
    pub files: PathBuf,
}

fn folder() -> PathBuf {
    workspace().join("target/usb-guest")
}

/// Names missing equipment, each with the command that installs it.
#[must_use]
pub fn missing() -> Option<String> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return Some("the guest runs programs of this machine, which isn't x86-64 Linux".to_owned());
    }
    let mut missing = Vec::new();
    if find_program(EMULATOR).is_err() {
        missing.push(format!("{EMULATOR} is not installed: run `cargo xtask setup`"));
    }
    if !folder().join("installed").is_file() {
        missing.push(format!("no kernel and udev in {}: run `cargo xtask setup`", folder().display()));
    }
    missing.extend(rom_loader::missing());
    (!missing.is_empty()).then(|| missing.join("\n"))
}

impl Equipment {
    /// Puts the file system together. `init` is the guest's first process, `programs` are those that the guest has elsewhere
    /// and whose libraries it needs.
    ///
    /// # Errors
    /// A part is missing.
    pub fn prepare(init: &Path, programs: &[&Path]) -> Result<Self> {
        let root = folder().join("root");
        let kernel = only_entry(&root.join("boot"))?;
        let udevadm = root.join("bin/udevadm");
        let flasher = find_program(rom_loader::PROGRAM).map_err(anyhow::Error::msg)?;
        let mut archive = Archive::default();
        for mounted in [
            "/proc",
            "/sys",
            "/dev",
            "/run",
            "/tmp",
            "/etc/udev/rules.d",
            super::request::WORKSPACE,
            super::request::PROGRAMS,
        ] {
            archive.folder(mounted);
        }
        archive.file("/init", 0o755, &read(init)?);
        archive.file("/bin/udevadm", 0o755, &read(&udevadm)?);
        archive.file(&format!("/bin/{}", rom_loader::PROGRAM), 0o755, &read(&flasher)?);
        for rule in RULES {
            let path = format!("/lib/udev/rules.d/{rule}");
            archive.file(&path, 0o644, &read(&root.join(path.trim_start_matches('/')))?);
        }
        archive.file("/etc/passwd", 0o644, b"root:x:0:0::/:/\nmember:x:1000:20::/:/\n");
        archive.file("/etc/group", 0o644, b"root:x:0:\ntty:x:5:\ndialout:x:20:member\n");
        let modules = modules::in_order(&only_entry(&root.join("lib/modules"))?)?;
        for (number, module) in modules.iter().enumerate() {
            archive.file(&format!("/modules/{number:02}"), 0o644, &read(module)?);
        }
        let mut libraries = BTreeSet::new();
        for program in programs.iter().copied().chain([init, udevadm.as_path(), flasher.as_path()]) {
            libraries.extend(libraries_of(program)?);
        }
        for library in libraries {
            archive.file(&library, 0o755, &read(Path::new(&library))?);
        }
        let files = folder().join(format!("files-{}.cpio", std::process::id()));
        fs::write(&files, archive.finish())
            .with_context(|| format!("{} can't be written", files.display()))?;
        Ok(Self { kernel, files })
    }
}

impl Drop for Equipment {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.files);
    }
}

fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| format!("{} can't be read", path.display()))
}

/// The one entry of a folder: a kernel of one version was unpacked.
fn only_entry(folder: &Path) -> Result<PathBuf> {
    let entries = fs::read_dir(folder).with_context(|| format!("{} is missing", folder.display()))?;
    let entries = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    let [entry] = <[PathBuf; 1]>::try_from(entries).map_err(|entries| {
        anyhow::anyhow!("{} has {} entries instead of 1", folder.display(), entries.len())
    })?;
    Ok(entry)
}

/// The shared libraries of a program and its loader, as the loader of this machine finds them.
fn libraries_of(program: &Path) -> Result<Vec<String>> {
    let output = Command::new("ldd").arg(program).output().context("ldd can't be started")?;
    let text = String::from_utf8(output.stdout)?;
    let missing: Vec<_> = text.lines().filter(|line| line.contains("not found")).map(str::trim).collect();
    ensure!(missing.is_empty(), "{} needs {}", program.display(), missing.join(", "));
    // `libc.so.6 => /lib/x86_64-linux-gnu/libc.so.6 (0x7f...)`, and the loader as a path alone.
    let paths = text.split_whitespace().filter(|word| word.starts_with('/'));
    Ok(paths.map(str::to_owned).collect())
}
