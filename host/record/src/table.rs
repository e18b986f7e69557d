//! Tables of numbers as CSV, written during a run.
//!
//! Rows are collected and written `flush_rows` at a time, so that an interrupted run leaves whole rows. This is ours because
//! `csv::Writer` writes its buffer whenever the buffer is full, in the middle of a row if need be, and emits the header with
//! the first row only.

use std::path::Path;

use lashloop_bench::atomic_file::{GrowingFile, WriteError};

use crate::digits::Digits;

/// Writes a table. [`finish`](Self::finish) reports whether the last rows were written; a dropped writer writes them too,
/// but can't report an error.
#[derive(Debug)]
pub struct TableWriter {
    file: GrowingFile,
    digits: Vec<Digits>,
    flush_rows: u32,
    pending: Vec<u8>,
    pending_rows: u32,
}

impl TableWriter {
    /// Creates the file with its header, in place of an older one. `columns` have a name and digits. `flush_rows` is the
    /// number of rows per chunk; 0 counts as 1.
    ///
    /// # Errors
    /// The file can't be created or the header can't be written.
    pub fn create<'a>(
        path: &Path,
        columns: impl IntoIterator<Item = (&'a str, Digits)>,
        flush_rows: u32,
    ) -> Result<Self, WriteError> {
        let (names, digits): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
        let mut line = csv::Writer::from_writer(Vec::new());
        // A Vec takes every byte.
        let _ = line.write_record(names);
        let line = line.into_inner().unwrap_or_default();
        Ok(Self {
            file: GrowingFile::create(path, ".table-", &line)?,
            digits,
            flush_rows,
            pending: Vec::new(),
            pending_rows: 0,
        })
    }

    /// Appends a row: the values in the order of the columns. A NaN leaves its field empty.
    ///
    /// # Errors
    /// A chunk is complete and can't be written. Its rows are lost, those before are kept.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) -> Result<(), WriteError> {
        for (value, digits) in row.into_iter().zip(&self.digits) {
            digits.push(value, &mut self.pending);
            self.pending.push(b',');
        }
        if let Some(last) = self.pending.last_mut() {
            *last = b'\n';
        }
        self.pending_rows += 1;
        if self.pending_rows < self.flush_rows { Ok(()) } else { self.flush() }
    }

    /// Writes the pending rows.
    ///
    /// # Errors
    /// The rows can't be written.
    pub fn finish(mut self) -> Result<(), WriteError> {
        self.flush()
    }

    fn flush(&mut self) -> Result<(), WriteError> {
        let result = self.file.append(&self.pending);
        self.pending.clear();
        self.pending_rows = 0;
        result
    }
}

impl Drop for TableWriter {
    fn drop(&mut self) {
        // `finish` reports this error.
        let _ = self.flush();
    }
}
