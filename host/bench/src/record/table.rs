//! Tables of numbers as CSV, written while a run goes on.
//!
//! Numbers are the shortest that read back to the same bits. Rows are collected and handed to the file `flush_rows` at a
//! time, each time whole, so that a run that is cut off leaves a table and not a torn line.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::atomic_file;
use crate::atomic_file::WriteError;

/// Writes a table. [`finish`](Self::finish) reports whether the last rows arrived; a writer that is merely
/// dropped writes them too, but has nobody to tell.
#[derive(Debug)]
pub struct TableWriter {
    path: PathBuf,
    file: File,
    flush_rows: u32,
    pending: Vec<u8>,
    pending_rows: u32,
    /// Bytes of whole rows in the file.
    written: u64,
}

impl TableWriter {
    /// Begins the file with its header; an older one is replaced when that is written. `flush_rows` is the number of rows that reach
    /// the file together; 0 counts as 1.
    ///
    /// # Errors
    /// The file can't be created or the header can't be written.
    pub fn create(path: &Path, columns: &[&str], flush_rows: u32) -> Result<Self, WriteError> {
        let header = columns.join(",") + "\n";
        Ok(Self {
            path: path.to_owned(),
            file: atomic_file::begin(path, ".table-", header.as_bytes())?,
            flush_rows,
            pending: Vec::new(),
            pending_rows: 0,
            written: header.len() as u64,
        })
    }

    /// Takes the next row.
    ///
    /// # Errors
    /// It was time to write and the file can't take the rows; they are lost, those before are kept.
    pub fn push(&mut self, row: &[f64]) -> Result<(), WriteError> {
        let mut number = zmij::Buffer::new();
        for value in row {
            self.pending.extend_from_slice(number.format(*value).as_bytes());
            self.pending.push(b',');
        }
        // The last column ends the line.
        if let Some(last) = self.pending.last_mut() {
            *last = b'\n';
        }
        self.pending_rows += 1;
        if self.pending_rows < self.flush_rows { Ok(()) } else { self.flush() }
    }

    /// Writes the rows that are still pending.
    ///
    /// # Errors
    /// The file can't take them.
    pub fn finish(mut self) -> Result<(), WriteError> {
        self.flush()
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        let result = self.file.write_all(&self.pending);
        if result.is_ok() {
            self.written += self.pending.len() as u64;
        } else {
            // A full disk may have taken part of a row. If this fails as well, the first error says enough.
            let _ = self.file.set_len(self.written);
            let _ = self.file.seek(SeekFrom::Start(self.written));
        }
        self.pending.clear();
        self.pending_rows = 0;
        result.map_err(|source| WriteError { path: self.path.clone(), action: "written", source })
    }
}

impl Drop for TableWriter {
    fn drop(&mut self) {
        // Nobody is left to tell; `finish` is there for whoever wants to know.
        let _ = self.flush();
    }
}
