//! A pseudo-terminal for a drive to serve.

use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::path::{Path, PathBuf};

use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, SpecialCodeIndex, tcgetattr, tcsetattr};

/// A pseudo-terminal in raw mode, whose line stays up between hosts as that of a serial port does. Dropping it
/// disconnects the line.
pub struct Terminal {
    /// The end that a drive reads and writes.
    pub far_end: OwnedFd,
    /// Where a host finds the near end.
    pub path: PathBuf,
    /// The line hangs up when the last holder of the near end closes it, so we hold one.
    _near_end: OwnedFd,
}

impl Terminal {
    /// Opens a new pseudo-terminal.
    ///
    /// # Errors
    /// The system has no pseudo-terminal left or none at all.
    pub fn open() -> io::Result<Self> {
        let far_end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&far_end)?;
        unlockpt(&far_end)?;
        let path = PathBuf::from(ptsname(&far_end, [])?.to_string_lossy().into_owned());
        let near_end = open_near_end(&path)?;
        set_raw(&near_end, 1, 0)?;
        Ok(Self { far_end, path, _near_end: near_end })
    }
}

/// Opens the near end of a pseudo-terminal without locking it or changing its settings.
///
/// # Errors
/// `path` is missing or may not be opened.
pub fn open_near_end(path: &Path) -> io::Result<OwnedFd> {
    Ok(rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?)
}

/// Puts a terminal into raw mode. A read returns with `min_bytes` bytes or after `timeout_tenths_s` tenths of a second;
/// 0 means no timeout.
///
/// # Errors
/// The file isn't a terminal, or its far end is disconnected.
pub fn set_raw(terminal: impl AsFd, min_bytes: u8, timeout_tenths_s: u8) -> io::Result<()> {
    let mut settings = tcgetattr(&terminal)?;
    settings.make_raw();
    settings.special_codes[SpecialCodeIndex::VMIN] = min_bytes;
    settings.special_codes[SpecialCodeIndex::VTIME] = timeout_tenths_s;
    Ok(tcsetattr(&terminal, OptionalActions::Now, &settings)?)
}
