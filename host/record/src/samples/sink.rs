//! A growing file behind the writer of MCAP: what the writer has written gets to the file with a flush, as one chunk.

use std::io::{self, Write};

use lashloop_bench::atomic_file::GrowingFile;

#[derive(Debug)]
pub(super) struct Sink {
    file: GrowingFile,
    pending: Vec<u8>,
    /// After a failure nothing more is written: an end without what precedes it would be wrong.
    has_failed: bool,
}

impl Sink {
    pub(super) fn new(file: GrowingFile) -> Self {
        Self { file, pending: Vec::new(), has_failed: false }
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.pending.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.has_failed {
            return Err(io::Error::other("an earlier chunk could not be written"));
        }
        let result = self.file.append(&self.pending);
        self.pending.clear();
        self.has_failed = result.is_err();
        result.map_err(|error| error.source)
    }
}
