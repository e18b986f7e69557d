//! The file of a capture.
//!
//! Packets are collected and written together when the bench is about to wait for the drive anyway. A bench that is
//! killed leaves whole packets, and all of those before its last wait; what a drive that hangs was asked is in the file.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use lashloop_protocol::layout::Direction;

use super::pcapng;
use crate::record::RecordError;

/// A capture in progress: one handle is with the link, another with whoever asked for it.
#[derive(Debug, Clone)]
pub struct Capture(Arc<Mutex<CaptureFile>>);

#[derive(Debug)]
struct CaptureFile {
    path: PathBuf,
    file: File,
    /// Whole blocks that are not in the file yet.
    pending: Vec<u8>,
    /// Bytes of whole blocks in the file.
    written: u64,
    packets: u64,
    /// When the capture began, on the calendar and on the clock that never jumps.
    began: (u64, Instant),
    fate: Fate,
}

#[derive(Debug)]
enum Fate {
    Good,
    /// The file takes nothing any more, and nobody has been told.
    Failed(RecordError),
    /// Somebody has been told.
    Told,
}

impl Capture {
    /// Creates the file, or empties it.
    ///
    /// # Errors
    /// The file can't be created or written.
    pub fn create(path: &Path) -> Result<Self, RecordError> {
        let failed = |source| RecordError { path: path.to_owned(), action: "created", source };
        let file = File::create(path).map_err(failed)?;
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let mut capture = CaptureFile {
            path: path.to_owned(),
            file,
            pending: pcapng::file_header(),
            written: 0,
            packets: 0,
            began: (since_1970.as_nanos() as u64, Instant::now()),
            fate: Fate::Good,
        };
        capture.flush();
        capture.told()?;
        Ok(Self(Arc::new(Mutex::new(capture))))
    }

    /// Takes a piece of the line as a packet of this moment. A file that has failed takes nothing more;
    /// [`check`](Self::check) tells.
    pub fn push(&self, direction: Direction, bytes: &[u8]) {
        let mut file = self.file();
        let (calendar_ns, instant) = file.began;
        let time_ns = calendar_ns + instant.elapsed().as_nanos() as u64;
        pcapng::append_packet(&mut file.pending, time_ns, direction, bytes);
        file.packets += 1;
    }

    /// Writes what is pending.
    pub fn flush(&self) {
        self.file().flush();
    }

    /// Whether the file takes what it is given; an error is told once.
    ///
    /// # Errors
    /// It does not; what it had taken before is whole.
    pub fn check(&self) -> Result<(), RecordError> {
        self.file().told()
    }

    /// Writes what is pending and gives the number of packets.
    ///
    /// # Errors
    /// The file did not take everything.
    pub fn finish(&self) -> Result<u64, RecordError> {
        let mut file = self.file();
        file.flush();
        file.told()?;
        Ok(file.packets)
    }

    /// A thread that panicked has left whole blocks.
    fn file(&self) -> MutexGuard<'_, CaptureFile> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl CaptureFile {
    fn flush(&mut self) {
        if self.pending.is_empty() {
            return;
        }
        if matches!(self.fate, Fate::Good) {
            match self.file.write_all(&self.pending) {
                Ok(()) => self.written += self.pending.len() as u64,
                Err(source) => {
                    // A full disk may have taken part of a block. If this fails as well, the first error says enough.
                    let _ = self.file.set_len(self.written);
                    let _ = self.file.seek(SeekFrom::Start(self.written));
                    let path = self.path.clone();
                    self.fate = Fate::Failed(RecordError { path, action: "written", source });
                }
            }
        }
        self.pending.clear();
    }

    fn told(&mut self) -> Result<(), RecordError> {
        if !matches!(self.fate, Fate::Failed(_)) {
            return Ok(());
        }
        match std::mem::replace(&mut self.fate, Fate::Told) {
            Fate::Failed(error) => Err(error),
            Fate::Good | Fate::Told => Ok(()),
        }
    }
}

impl Drop for CaptureFile {
    fn drop(&mut self) {
        // Nobody is left to tell; `finish` is there for whoever wants to know.
        self.flush();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_that_is_full_is_told_once_and_by_name() {
        let error = Capture::create(Path::new("/dev/full")).expect_err("it takes nothing");
        assert_eq!((error.path.as_path(), error.action), (Path::new("/dev/full"), "written"));
    }

    #[test]
    fn a_file_holds_whole_packets_at_every_flush() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("line.pcapng");
        let capture = Capture::create(&path).unwrap();
        let len = || std::fs::metadata(&path).unwrap().len();
        let header = pcapng::file_header().len() as u64;
        assert_eq!(len(), header);
        capture.push(Direction::HostToDrive, &[1, 2, 0]);
        assert_eq!(len(), header, "a packet waits for the flush");
        capture.flush();
        assert_eq!(len(), header + 48);
        capture.push(Direction::DriveToHost, &[1, 0]);
        drop(capture);
        assert_eq!(len(), header + 96, "the last one is written at the end");
    }
}
