//! Files of results that a later command continues: their lock, and why one is not continued.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use rustix::io::Errno;

/// Timeout for the lock of another process.
const LOCK_TIMEOUT: Duration = Duration::from_millis(500);

/// Results that this command may not continue.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// There are results, and the command does not resume.
    #[error("{} already holds results: resume with --resume, or choose another folder with --out", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// Another process has the lock.
    #[error("{} is being written by another lashloop: wait for its end, or choose another folder with --out", path.display())]
    InUse {
        /// The file.
        path: PathBuf,
    },
    /// The results belong to another command.
    #[error(
        "{} can't be resumed: its {what} is {there}, here it is {here}; make them the same, or choose another folder with --out",
        path.display()
    )]
    Other {
        /// The file.
        path: PathBuf,
        /// What differs.
        what: &'static str,
        /// Its value in the file.
        there: String,
        /// Its value in this command.
        here: String,
    },
}

/// Locks a file or a folder, until it is closed. `false` if another process has the lock.
///
/// A new child process holds copies of its parent's locks until it executes its own program. A released lock can therefore
/// stay taken for a moment.
///
/// On a file system [without locks](has_locks) no other process has one.
///
/// # Errors
/// The file system fails.
pub fn lock(file: &File) -> io::Result<bool> {
    let deadline = Instant::now() + LOCK_TIMEOUT;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(true),
            Err(TryLockError::WouldBlock) if Instant::now() < deadline => thread::sleep(LOCK_TIMEOUT / 50),
            Err(TryLockError::WouldBlock) => return Ok(false),
            Err(TryLockError::Error(source)) if lacks_locks(&source) => return Ok(true),
            Err(TryLockError::Error(source)) => return Err(source),
        }
    }
}

/// Whether the file system of a folder has locks. Lustre without `-o flock` has none.
///
/// # Errors
/// No file can be created in the folder.
pub fn has_locks(folder: &Path) -> io::Result<bool> {
    let file = tempfile::tempfile_in(folder)?;
    Ok(!matches!(file.try_lock(), Err(TryLockError::Error(source)) if lacks_locks(&source)))
}

fn lacks_locks(error: &io::Error) -> bool {
    matches!(Errno::from_io_error(error), Some(Errno::NOSYS | Errno::OPNOTSUPP))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_system_without_locks_differs_from_one_that_fails() {
        let lacks = |errno: Errno| lacks_locks(&errno.into());
        assert!(lacks(Errno::NOSYS) && lacks(Errno::NOTSUP) && !lacks(Errno::IO));
        assert!(has_locks(&std::env::temp_dir()).expect("a folder"));
    }
}
