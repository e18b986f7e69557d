//! From an empty kernel to drivers, udev and the folders of the tests.

use std::fs::{self, File};
use std::os::unix::process::CommandExt;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use rustix::mount::{MountFlags, mount};
use rustix::system::{RebootCommand, finit_module, reboot};

use tests::usb_guest::request::{PROGRAMS, WORKSPACE};

/// Options of a folder of the host.
const SHARE: &str = "trans=virtio,version=9p2000.L,msize=262144,cache=loose";

/// Mounts the file systems, loads the drivers and starts udev.
pub(crate) fn boot() -> Result<()> {
    for (kind, place) in [("proc", "/proc"), ("sysfs", "/sys"), ("devtmpfs", "/dev")] {
        attach(kind, kind, place, "")?;
    }
    for place in ["/run", "/tmp"] {
        attach("tmpfs", "tmpfs", place, "mode=1777")?;
    }
    load_modules()?;
    attach("workspace", "9p", WORKSPACE, SHARE)?;
    attach("programs", "9p", PROGRAMS, SHARE)?;
    // The daemon is the same program, by its other name.
    run(Command::new("/bin/udevadm").arg0("systemd-udevd").arg("--daemon"))?;
    // Devices of other subsystems are there since before the daemon, hundreds of them, and no trial needs what udev does with them.
    run(Command::new("/bin/udevadm").args(["trigger", "--subsystem-match=usb"]))?;
    settle()
}

/// Waits until udev has served all events.
pub(crate) fn settle() -> Result<()> {
    run(Command::new("/bin/udevadm").args(["settle", "--timeout=30"]))
}

/// Ends the emulator.
pub(crate) fn power_off() -> Result<()> {
    rustix::fs::sync();
    reboot(RebootCommand::PowerOff).context("power off")
}

fn attach(source: &str, kind: &str, place: &str, options: &str) -> Result<()> {
    let options = std::ffi::CString::new(options)?;
    mount(source, place, kind, MountFlags::empty(), options.as_c_str())
        .with_context(|| format!("{kind} on {place}"))
}

fn load_modules() -> Result<()> {
    let mut files: Vec<_> =
        fs::read_dir("/modules")?.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    files.sort();
    for file in files {
        match finit_module(File::open(&file)?, c"", 0) {
            // Another module has loaded it.
            Ok(()) | Err(rustix::io::Errno::EXIST) => {}
            Err(error) => return Err(error).with_context(|| file.display().to_string()),
        }
    }
    Ok(())
}

fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("{command:?}"))?;
    ensure!(status.success(), "{command:?} ended with {status}");
    Ok(())
}
