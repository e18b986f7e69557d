//! Pseudo-terminals in raw mode.

use std::fs::File;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};

use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

/// A pseudo-terminal. Dropping it pulls the line: whoever has opened its path sees the far end gone.
pub struct Terminal {
    /// Where a drive sits.
    pub far_end: File,
    path: PathBuf,
    /// Held open, so that the line is up before and between hosts.
    _near_end: File,
}

impl Terminal {
    /// A new one.
    ///
    /// # Panics
    /// The system has none left.
    #[must_use]
    pub fn open() -> Self {
        let opened = || -> rustix::io::Result<(OwnedFd, PathBuf)> {
            let far_end = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
            grantpt(&far_end)?;
            unlockpt(&far_end)?;
            let path = ptsname(&far_end, [])?.to_string_lossy().into_owned().into();
            Ok((far_end, path))
        };
        let (far_end, path) = opened().expect("a pseudo-terminal");
        let near_end = open_near_end(&path);
        Self { far_end: far_end.into(), path, _near_end: near_end }
    }

    /// Where a host finds it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The terminal as `--device` takes it.
    #[must_use]
    pub fn device(&self) -> String {
        self.path.display().to_string()
    }
}

/// Opens the near end of a terminal as a host does, without locking it.
///
/// # Panics
/// It is not there.
#[must_use]
pub fn open_near_end(path: &Path) -> File {
    let opened = || -> rustix::io::Result<OwnedFd> {
        let end = rustix::fs::open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
        let mut settings = tcgetattr(&end)?;
        settings.make_raw();
        tcsetattr(&end, OptionalActions::Now, &settings)?;
        Ok(end)
    };
    opened().unwrap_or_else(|error| panic!("{}: {error}", path.display())).into()
}
