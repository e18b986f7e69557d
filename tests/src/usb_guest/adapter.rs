//! QEMU's model of an FTDI adapter: it is plugged in as long as a program is connected to its socket.

use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::thread::{self, JoinHandle};

use crate::terminal::open_near_end;

/// The adapter plugged in, with the terminal of a drive at its far end. Dropping it unplugs the adapter.
pub struct Plugged {
    socket: UnixStream,
    threads: Vec<JoinHandle<()>>,
}

impl Plugged {
    /// Plugs the adapter in.
    ///
    /// # Panics
    /// The socket or the terminal is missing.
    #[must_use]
    pub fn insert(adapter: &Path, drive: &Path) -> Self {
        let socket = UnixStream::connect(adapter).expect("the emulator's socket");
        let drive = open_near_end(drive);
        let handles = || (socket.try_clone().expect("a handle"), drive.try_clone().expect("a handle"));
        let ((mut from_host, mut to_drive), (mut to_host, mut from_drive)) = (handles(), handles());
        let there = thread::spawn(move || copy(&mut from_host, &mut to_drive));
        // Ends with the next byte of the drive after the adapter is unplugged, so it isn't waited for.
        thread::spawn(move || copy(&mut from_drive, &mut to_host));
        Self { socket, threads: vec![there] }
    }
}

impl Drop for Plugged {
    fn drop(&mut self) {
        let _ = self.socket.shutdown(Shutdown::Both);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn copy(from: &mut impl Read, to: &mut impl Write) {
    let mut piece = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut piece) {
        if to.write_all(&piece[..count]).is_err() {
            return;
        }
    }
}
