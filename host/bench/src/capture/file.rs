//! The file of a capture: packets are collected and written together as whole blocks.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use lashloop_protocol::layout::Direction;

use super::pcapng;
use crate::atomic_file;
use crate::atomic_file::WriteError;

#[derive(Debug)]
pub(super) struct CaptureFile {
    path: PathBuf,
    file: File,
    /// Whole blocks that are not in the file yet.
    pending: Vec<u8>,
    /// Packets among them.
    pending_packets: u64,
    /// Bytes of whole blocks in the file.
    written: u64,
    packets: u64,
    /// A write has failed; nothing more is written.
    failed: bool,
}

impl CaptureFile {
    /// Creates the file with its header, in place of an older one.
    ///
    /// # Errors
    /// The file can't be created or written.
    pub(super) fn create(path: &Path) -> Result<Self, WriteError> {
        let header = pcapng::file_header();
        Ok(Self {
            path: path.to_owned(),
            file: atomic_file::begin(path, ".capture-", &header)?,
            pending: Vec::new(),
            pending_packets: 0,
            written: header.len() as u64,
            packets: 0,
            failed: false,
        })
    }

    /// Takes a packet. A file that has failed takes nothing more.
    pub(super) fn push(&mut self, time_ns: u64, direction: Direction, bytes: &[u8]) {
        if !self.failed {
            pcapng::append_packet(&mut self.pending, time_ns, direction, bytes);
            self.pending_packets += 1;
        }
    }

    /// Packets in the file.
    pub(super) fn packets(&self) -> u64 {
        self.packets
    }

    /// Writes what is pending.
    ///
    /// # Errors
    /// The file does not take it; told once. What it had taken before is whole.
    pub(super) fn flush(&mut self) -> Result<(), WriteError> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let written = self.file.write_all(&self.pending);
        match &written {
            Ok(()) => {
                self.written += self.pending.len() as u64;
                self.packets += self.pending_packets;
            }
            Err(_) => {
                self.failed = true;
                // A full disk may have taken part of a block. If this fails as well, the first error says enough.
                let _ = self.file.set_len(self.written);
                let _ = self.file.seek(SeekFrom::Start(self.written));
            }
        }
        self.pending.clear();
        self.pending_packets = 0;
        written.map_err(|source| WriteError { path: self.path.clone(), action: "written", source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_holds_whole_packets_at_every_flush() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("line.pcapng");
        let mut capture = CaptureFile::create(&path).unwrap();
        let len = || std::fs::metadata(&path).unwrap().len();
        let header = pcapng::file_header().len() as u64;
        assert_eq!(len(), header);
        capture.push(0, Direction::HostToDrive, &[1, 2, 0]);
        assert_eq!((len(), capture.packets()), (header, 0), "a packet waits for the flush");
        capture.flush().unwrap();
        assert_eq!((len(), capture.packets()), (header + 48, 1));
    }
}
