//! The results of a battery as they come: one line of JSON each, so that a battery that was cut off can go on.
//!
//! The first line says what the results belong to. A line reaches the file whole, and half a line that a power failure left at
//! the end is dropped: its run is made again.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::plan::Settings;
use super::runs::CaseResult;

/// What the results of a file belong to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of Lashloop.
    pub lashloop: String,
    /// The program that made the runs, plant and drive and all: SHA-256 of its file.
    pub program_sha256: String,
    /// Which runs.
    pub settings: Settings,
}

/// Why results can't be kept or not be gone on with.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The system refused.
    #[error("{}: can't be {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// `opened`, `read` or `written`.
        action: &'static str,
        /// Its reason.
        source: io::Error,
    },
    /// There are results already.
    #[error("{} holds results already: go on with --resume, or choose another folder with --out", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// Another battery writes to it.
    #[error("{} is being written by another lashloop: wait for its end, or choose another folder with --out", path.display())]
    InUse {
        /// The file.
        path: PathBuf,
    },
    /// The results are those of another battery.
    #[error(
        "{} can't be gone on with: its {what} is {there}, here it is {here}; make them the same, or choose another folder with --out",
        path.display()
    )]
    Other {
        /// The file.
        path: PathBuf,
        /// What differs.
        what: &'static str,
        /// What the file says.
        there: String,
        /// What was asked for.
        here: String,
    },
    /// A line is no result.
    #[error("{}:{line}: {problem}; choose another folder with --out, or remove the line", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
}

/// How long a lock of somebody else is waited for.
const LOCK_PATIENCE: Duration = Duration::from_millis(500);

/// An open file of results, locked for this process.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Bytes of whole lines in the file.
    written: u64,
}

impl Journal {
    /// Begins a new file.
    ///
    /// # Errors
    /// There is one already, or the system refuses.
    pub fn create(path: &Path, header: &Header) -> Result<Self, JournalError> {
        let file = OpenOptions::new().append(true).create_new(true).open(path);
        let file = file.map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => JournalError::Exists { path: path.to_owned() },
            _ => io_error(path, "opened")(source),
        })?;
        let mut journal = Self::lock(path, file)?;
        journal.write(header)?;
        Ok(journal)
    }

    /// Goes on with a file and hands over what is in it; begins one if there is none. `take` says what is wrong with a result
    /// that it does not want.
    ///
    /// # Errors
    /// The file belongs to another battery, is in use, or holds a line that is none of its results.
    pub fn resume(
        path: &Path,
        header: &Header,
        mut take: impl FnMut(CaseResult) -> Result<(), &'static str>,
    ) -> Result<Self, JournalError> {
        let file = OpenOptions::new().read(true).append(true).create(true).open(path);
        let mut journal = Self::lock(path, file.map_err(io_error(path, "opened"))?)?;
        let mut text = String::new();
        journal.file.read_to_string(&mut text).map_err(io_error(path, "read"))?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        if whole < text.len() {
            journal.file.set_len(whole as u64).map_err(io_error(path, "written"))?;
        }
        journal.written = whole as u64;
        let mut lines = text[..whole].lines();
        let Some(first) = lines.next() else {
            journal.write(header)?;
            return Ok(journal);
        };
        journal.parse::<Header>(1, first).and_then(|there| journal.compare(&there, header))?;
        for (line, text) in (2..).zip(lines) {
            let result = journal.parse(line, text)?;
            take(result).map_err(|problem| journal.malformed(line, problem.to_owned()))?;
        }
        Ok(journal)
    }

    /// Keeps a result.
    ///
    /// # Errors
    /// The file can't take it; what is in it stays whole.
    pub fn append(&mut self, result: &CaseResult) -> Result<(), JournalError> {
        self.write(result)
    }

    /// A process that is just being started holds copies of all locks of its parent until it runs its own program. So a
    /// lock that has been given back may be taken for a moment longer.
    fn lock(path: &Path, file: File) -> Result<Self, JournalError> {
        let give_up = Instant::now() + LOCK_PATIENCE;
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Self { path: path.to_owned(), file, written: 0 }),
                Err(TryLockError::WouldBlock) if Instant::now() < give_up => {
                    thread::sleep(LOCK_PATIENCE / 50);
                }
                Err(TryLockError::WouldBlock) => return Err(JournalError::InUse { path: path.to_owned() }),
                Err(TryLockError::Error(source)) => return Err(io_error(path, "opened")(source)),
            }
        }
    }

    fn write(&mut self, line: &impl Serialize) -> Result<(), JournalError> {
        let written = serde_json::to_vec(line).map_err(io::Error::from).and_then(|mut bytes| {
            bytes.push(b'\n');
            self.file.write_all(&bytes).map(|()| bytes.len())
        });
        match written {
            Ok(count) => {
                self.written += count as u64;
                Ok(())
            }
            Err(source) => {
                // A full disk may have taken half a line. If this fails as well, the first error says enough.
                let _ = self.file.set_len(self.written);
                Err(io_error(&self.path, "written")(source))
            }
        }
    }

    fn parse<T: for<'a> Deserialize<'a>>(&self, line: usize, text: &str) -> Result<T, JournalError> {
        serde_json::from_str(text).map_err(|error| self.malformed(line, error.to_string()))
    }

    /// The error for a line that is none of this battery's.
    fn malformed(&self, line: usize, problem: String) -> JournalError {
        JournalError::Malformed { path: self.path.clone(), line, problem }
    }

    fn compare(&self, there: &Header, here: &Header) -> Result<(), JournalError> {
        let spell = |header: &Header| {
            let Header { lashloop, program_sha256, settings } = header;
            let laws: Vec<_> = settings.laws.iter().map(|law| law.name()).collect();
            [
                ("version", lashloop.clone()),
                ("seed", settings.seed.to_string()),
                ("number of plants", settings.plants.to_string()),
                ("list of controllers", laws.join(",")),
                ("choice of sweeps", if settings.sweeps { "with" } else { "without" }.to_owned()),
                ("program's SHA-256", program_sha256.clone()),
            ]
        };
        let differs = spell(there).into_iter().zip(spell(here)).find(|(there, here)| there != here);
        match differs {
            None => Ok(()),
            Some(((what, there), (_, here))) => {
                Err(JournalError::Other { path: self.path.clone(), what, there, here })
            }
        }
    }
}

fn io_error(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> JournalError {
    move |source| JournalError::Io { path: path.to_owned(), action, source }
}

#[cfg(test)]
mod tests;
