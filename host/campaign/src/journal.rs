//! A journal: one line of JSON per result, so that an interrupted command of many runs can resume.
//!
//! The first line identifies the command. Each line is one write. A partial line at the end, after a power failure, is
//! discarded and its run is repeated.

use std::fs;
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use lashloop_bench::resume::{self, ResumeError};
use lashloop_bench::run::digest;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// What a journal belongs to.
pub trait JournalHeader: Serialize + DeserializeOwned {
    /// Names and values that must be equal to resume.
    fn facts(&self) -> Vec<(&'static str, String)>;
}

#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    #[error("{}: can't be {action}: {source}", path.display())]
    Io { path: PathBuf, action: &'static str, source: io::Error },
    #[error(transparent)]
    Resume(#[from] ResumeError),
    #[error("{}:{line}: {problem}; choose another folder with --out, or remove the line", path.display())]
    Malformed {
        path: PathBuf,
        /// From 1.
        line: usize,
        problem: String,
    },
}

/// SHA-256 of this program's file. Plant and drive are part of it, so another build may give other results.
///
/// # Errors
/// The file can't be read.
pub fn program_sha256() -> io::Result<String> {
    std::env::current_exe().and_then(fs::read).map(|bytes| digest::sha256(&bytes))
}

/// An open journal, locked for this process.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Bytes of whole lines in the file.
    written: u64,
}

impl Journal {
    /// Creates a journal.
    ///
    /// # Errors
    /// The file exists, or the system refuses it.
    pub fn create(path: &Path, header: &impl JournalHeader) -> Result<Self, JournalError> {
        let file = OpenOptions::new().append(true).create_new(true).open(path);
        let file = file.map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => ResumeError::Exists { path: path.to_owned() }.into(),
            _ => io_error(path, "opened")(source),
        })?;
        let mut journal = Self::lock(path, file)?;
        journal.write(header)?;
        Ok(journal)
    }

    /// Creates a journal, instead of an earlier one that no process writes.
    ///
    /// # Errors
    /// The earlier one is in use, or the system refuses the file.
    pub fn replace(path: &Path, header: &impl JournalHeader) -> Result<Self, JournalError> {
        let file = OpenOptions::new().append(true).create(true).open(path);
        let mut journal = Self::lock(path, file.map_err(io_error(path, "opened"))?)?;
        journal.file.set_len(0).map_err(io_error(path, "written"))?;
        journal.write(header)?;
        Ok(journal)
    }

    /// Opens a journal and passes its results to `take`; creates one if none exists. `take` refuses a result with the
    /// reason.
    ///
    /// # Errors
    /// The journal belongs to another command, is in use, or holds a malformed or refused line.
    pub fn resume<H: JournalHeader, R: DeserializeOwned>(
        path: &Path,
        header: &H,
        mut take: impl FnMut(R) -> Result<(), &'static str>,
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
        journal.parse::<H>(1, first).and_then(|there| journal.compare(&there, header))?;
        for (line, text) in (2..).zip(lines) {
            let result = journal.parse(line, text)?;
            take(result).map_err(|problem| journal.malformed(line, problem.to_owned()))?;
        }
        Ok(journal)
    }

    /// Appends a result.
    ///
    /// # Errors
    /// The write fails; the lines before it stay intact.
    pub fn append(&mut self, result: &impl Serialize) -> Result<(), JournalError> {
        self.write(result)
    }

    fn lock(path: &Path, file: File) -> Result<Self, JournalError> {
        if !resume::lock(&file).map_err(io_error(path, "locked"))? {
            return Err(ResumeError::InUse { path: path.to_owned() }.into());
        }
        Ok(Self { path: path.to_owned(), file, written: 0 })
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
                // A full disk may leave a partial line. If the truncation fails too, the first error suffices.
                let _ = self.file.set_len(self.written);
                Err(io_error(&self.path, "written")(source))
            }
        }
    }

    fn parse<T: DeserializeOwned>(&self, line: usize, text: &str) -> Result<T, JournalError> {
        serde_json::from_str(text).map_err(|error| self.malformed(line, error.to_string()))
    }

    fn malformed(&self, line: usize, problem: String) -> JournalError {
        JournalError::Malformed { path: self.path.clone(), line, problem }
    }

    fn compare<H: JournalHeader>(&self, there: &H, here: &H) -> Result<(), JournalError> {
        let differs = there.facts().into_iter().zip(here.facts()).find(|(there, here)| there != here);
        match differs {
            None => Ok(()),
            Some(((what, there), (_, here))) => {
                Err(ResumeError::Other { path: self.path.clone(), what, there, here }.into())
            }
        }
    }
}

fn io_error(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> JournalError {
    move |source| JournalError::Io { path: path.to_owned(), action, source }
}
