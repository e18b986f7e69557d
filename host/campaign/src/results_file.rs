//! A file of results that grows by whole lines, so that an interrupted command can resume after the last one.
//!
//! It is locked for one process. Each line is one write; a partial one, after a kill or on a full disk, is cut off, and its run
//! is repeated.

use std::fs::{File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use lashloop_bench::resume::{self, ResumeError};

use crate::error::{CampaignError, io_error};

/// An open file of results.
#[derive(Debug)]
pub(crate) struct ResultsFile {
    pub path: PathBuf,
    /// At its end, whatever was read.
    pub file: File,
    /// Bytes of whole lines.
    bytes: u64,
}

impl ResultsFile {
    /// Opens a file, or creates an empty one. Its lines count once they were read and kept by [`cut`](Self::cut).
    ///
    /// # Errors
    /// Another process has it, or the system refuses it.
    pub fn open(path: &Path) -> Result<Self, CampaignError> {
        Self::open_with(path, OpenOptions::new().create(true))
    }

    /// Creates a file.
    ///
    /// # Errors
    /// It exists, or the system refuses it.
    pub fn create(path: &Path) -> Result<Self, CampaignError> {
        Self::open_with(path, OpenOptions::new().create_new(true))
    }

    fn open_with(path: &Path, options: &mut OpenOptions) -> Result<Self, CampaignError> {
        let file = options.read(true).append(true).open(path).map_err(|source| match source.kind() {
            io::ErrorKind::AlreadyExists => ResumeError::Exists { path: path.to_owned() }.into(),
            _ => io_error(path, "opened")(source),
        })?;
        if !resume::lock(&file).map_err(io_error(path, "locked"))? {
            return Err(ResumeError::InUse { path: path.to_owned() }.into());
        }
        Ok(Self { path: path.to_owned(), file, bytes: 0 })
    }

    /// Keeps the first bytes, which must be whole lines.
    ///
    /// # Errors
    /// The system refuses it.
    pub fn cut(&mut self, bytes: u64) -> Result<(), CampaignError> {
        self.bytes = bytes;
        self.file.set_len(bytes).map_err(io_error(&self.path, "written"))
    }

    /// Appends a line with its end.
    ///
    /// # Errors
    /// The write fails; the lines before it stay intact.
    pub fn append(&mut self, line: &[u8]) -> Result<(), CampaignError> {
        self.file.write_all(line).map_err(|source| {
            // A full disk may have taken part of the line. If the cut fails too, the first error suffices: resuming cuts.
            let _ = self.file.set_len(self.bytes);
            io_error(&self.path, "written")(source)
        })?;
        self.bytes += line.len() as u64;
        Ok(())
    }
}
