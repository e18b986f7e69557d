//! One program at a time on a rig: an advisory lock (`flock`) on a file that is named after the device.
//!
//! The terminal itself is opened exclusively. That isn't enough: flashing closes it, an unplugged adapter has none, and the
//! second program should learn who uses the rig. The kernel releases the lock with the process, however it ends.

use std::collections::BTreeSet;
use std::fs::{self, File, Permissions};
use std::io::{self, Read, Seek, Write};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::process;

use lashloop_session::printable;
use rustix::fs::{FlockOperation, Mode, OFlags, flock};

/// Where locks of all users of a machine are, as far as the folder is open to all of them.
const FOLDERS: [&str; 2] = ["/run/lock", "/tmp"];
/// Longest text about a holder, in bytes.
const LONGEST_HOLDER: u64 = 300;
/// All users may lock a rig.
const MODE: u32 = 0o666;

/// Why a rig can't be locked.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another program uses the rig.
    #[error("{device}: the rig is in use by {holder}: wait for its end, or stop it")]
    Held {
        /// Device of the rig.
        device: String,
        /// Process, user and command of the holder, as it wrote them.
        holder: String,
    },
    /// The system refused.
    #[error("{}: the lock of the rig can't be taken: {source}; remove the file, or its owner does", path.display())]
    System { path: PathBuf, source: io::Error },
}

/// A rig that this process uses. Dropping it releases the rig.
#[derive(Debug)]
pub struct RigLock {
    _files: Vec<LockedFile>,
}

#[derive(Debug)]
struct LockedFile {
    file: File,
    path: PathBuf,
}

impl RigLock {
    /// Locks the rig with this device: under its name, which stays while a chip in its boot loader has no port, and
    /// under that of the terminal that it now points to, which has several names. `purpose` is what the program does, for the message of the next one.
    ///
    /// # Errors
    /// Another program holds the lock, or the system refused.
    pub fn take(device: &str, purpose: &str) -> Result<Self, LockError> {
        Self::take_in(folder(), device, purpose)
    }

    fn take_in(folder: &Path, device: &str, purpose: &str) -> Result<Self, LockError> {
        let terminal = Path::new(device).canonicalize().ok();
        let terminal = terminal.map(|path| path.display().to_string());
        let names: BTreeSet<_> = terminal.into_iter().chain([device.to_owned()]).collect();
        let lock = |name: String| LockedFile::take(&folder.join(file_name(&name)), device, purpose);
        Ok(Self { _files: names.into_iter().map(lock).collect::<Result<_, _>>()? })
    }
}

impl LockedFile {
    fn take(path: &Path, device: &str, purpose: &str) -> Result<Self, LockError> {
        let failed = |source| LockError::System { path: path.to_owned(), source };
        loop {
            let mut file = open(path).map_err(failed)?;
            match flock(&file, FlockOperation::NonBlockingLockExclusive) {
                Ok(()) => {}
                Err(rustix::io::Errno::WOULDBLOCK) => {
                    return Err(LockError::Held { device: device.to_owned(), holder: holder(&mut file) });
                }
                Err(error) => return Err(failed(error.into())),
            }
            // The holder before us may have removed the file between our opening and our lock.
            if is_at(&file, path) {
                write(&mut file, purpose).map_err(failed)?;
                return Ok(Self { file, path: path.to_owned() });
            }
        }
    }
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        // Under the lock. In a folder with the sticky bit only the owner of a file may remove it; an empty file does no harm.
        let _ = self.file.set_len(0);
        let _ = fs::remove_file(&self.path);
    }
}

/// The first folder that every user may write to, so that all users look for a lock in one place.
fn folder() -> &'static Path {
    let is_open_to_all =
        |folder: &&&str| fs::metadata(folder).is_ok_and(|it| it.is_dir() && it.mode() & 0o002 != 0);
    Path::new(FOLDERS.iter().find(is_open_to_all).unwrap_or(&FOLDERS[1]))
}

/// `lashloop-` and the device, with a dash for every character that a file name should not have.
fn file_name(device: &str) -> String {
    let name: String =
        device.chars().map(|c| if c.is_ascii_alphanumeric() || "._".contains(c) { c } else { '-' }).collect();
    format!("lashloop{}{name}.lock", if name.starts_with('-') { "" } else { "-" })
}

/// Opens the file, or creates it. Creating an existing file of another user is refused in a folder with the sticky bit
/// (`fs.protected_regular`), so the two are separate. A symbolic link is never followed.
fn open(path: &Path) -> io::Result<File> {
    let flags = OFlags::RDWR | OFlags::CLOEXEC | OFlags::NOFOLLOW;
    loop {
        match rustix::fs::open(path, flags, Mode::empty()) {
            Err(rustix::io::Errno::NOENT) => {}
            opened => return Ok(opened?.into()),
        }
        match rustix::fs::open(path, flags | OFlags::CREATE | OFlags::EXCL, Mode::from_raw_mode(MODE)) {
            Err(rustix::io::Errno::EXIST) => {}
            created => {
                let file = File::from(created?);
                // The mask of the user doesn't apply here.
                file.set_permissions(Permissions::from_mode(MODE))?;
                return Ok(file);
            }
        }
    }
}

fn is_at(file: &File, path: &Path) -> bool {
    let same = |a: fs::Metadata, b: fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    file.metadata().is_ok_and(|here| fs::symlink_metadata(path).is_ok_and(|there| same(here, there)))
}

fn write(file: &mut File, purpose: &str) -> io::Result<()> {
    let user =
        std::env::var("USER").unwrap_or_else(|_| format!("user {}", rustix::process::getuid().as_raw()));
    file.set_len(0)?;
    file.rewind()?;
    write!(file, "process {} of {user}: {purpose}", process::id())
}

fn holder(file: &mut File) -> String {
    let mut text = Vec::new();
    let read = file.rewind().and_then(|()| file.take(LONGEST_HOLDER).read_to_end(&mut text));
    match read {
        Ok(1..) => printable(&String::from_utf8_lossy(&text)),
        Ok(0) | Err(_) => "a program that has just started".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEVICE: &str = "/dev/serial/by-id/usb-FTDI_A50285BI-if00-port0";

    #[test]
    fn a_second_lock_names_the_holder_and_its_purpose() {
        let folder = tempfile::tempdir().unwrap();
        let first = RigLock::take_in(folder.path(), DEVICE, "run a.toml").expect("a free rig");
        let error = RigLock::take_in(folder.path(), DEVICE, "flash").expect_err("a rig in use").to_string();
        let process = format!("process {} of ", process::id());
        assert!(
            error.starts_with(DEVICE) && error.contains(&process) && error.contains("run a.toml"),
            "{error}"
        );
        let other = RigLock::take_in(folder.path(), "tcp:rack:4000", "run b.toml").expect("another rig");
        drop((first, other));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "released locks leave files");
        RigLock::take_in(folder.path(), DEVICE, "flash").expect("a released rig");
    }

    #[test]
    fn two_names_of_a_terminal_are_one_rig() {
        let folder = tempfile::tempdir().unwrap();
        let [terminal, one, other] = ["ttyACM0", "by-id", "by-path"].map(|name| folder.path().join(name));
        fs::write(&terminal, "").unwrap();
        let name = |path: &Path| path.display().to_string();
        for link in [&one, &other] {
            std::os::unix::fs::symlink(&terminal, link).unwrap();
        }
        let take = |device: &Path| RigLock::take_in(folder.path(), &name(device), "flash");
        let held = take(&one).expect("a free rig");
        assert!(matches!(take(&other), Err(LockError::Held { .. })));
        // A chip in its boot loader has no port.
        fs::remove_file(&terminal).unwrap();
        assert!(matches!(take(&one), Err(LockError::Held { .. })));
        drop(held);
        drop(take(&other).expect("a released rig"));
    }

    #[test]
    fn a_file_without_a_holder_is_no_lock_and_a_link_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(file_name(DEVICE));
        fs::write(&path, "process 1 of root: run old.toml, and then a power failure").unwrap();
        drop(RigLock::take_in(folder.path(), DEVICE, "run").expect("a lock that no process holds"));
        let target = folder.path().join("precious");
        fs::write(&target, "kept").unwrap();
        std::os::unix::fs::symlink(&target, &path).unwrap();
        let error = RigLock::take_in(folder.path(), DEVICE, "run").expect_err("a link");
        assert!(matches!(error, LockError::System { .. }), "{error}");
        assert_eq!(fs::read_to_string(&target).unwrap(), "kept");
    }

    #[test]
    fn the_kernel_releases_the_lock_of_a_dead_holder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(file_name(DEVICE));
        // flock(1) of util-linux, which becomes a program that is then killed.
        let mut holder = process::Command::new("flock")
            .args(["--exclusive", "--no-fork"])
            .arg(&path)
            .args(["sh", "-c", "echo; exec sleep 60"])
            .stdout(process::Stdio::piped())
            .spawn()
            .expect("flock of util-linux");
        holder.stdout.take().expect("a pipe").read_exact(&mut [0]).expect("the lock is taken");
        RigLock::take_in(folder.path(), DEVICE, "run").expect_err("a rig in use");
        holder.kill().unwrap();
        holder.wait().unwrap();
        RigLock::take_in(folder.path(), DEVICE, "run").expect("a rig whose holder was killed");
    }

    #[test]
    fn devices_have_files_of_their_own() {
        assert_eq!(file_name("/dev/serial/by-id/usb-A"), "lashloop-dev-serial-by-id-usb-A.lock");
        assert_eq!(file_name("tcp:[::1]:4000"), "lashloop-tcp----1--4000.lock");
        assert_ne!(file_name("tcp:rack:1"), file_name("tcp:rack:2"));
    }
}
