//! From the loop to the file: a lock-free ring passes packets to a thread that writes them.
//!
//! The loop neither locks nor allocates nor writes for its capture. The thread empties the ring every [`FLUSH`], so that a
//! killed bench loses only the packets of that time. The file holds whole packets at any time. A full ring never loses a
//! packet silently: in lockstep the loop waits for the disk; in real time, where it can't, the run ends with an error.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use lashloop_protocol::layout::Direction;
use rtrb::{Consumer, Producer, RingBuffer};

use super::file::CaptureFile;
use crate::atomic_file::WriteError;

/// How often packets reach the file.
pub const FLUSH: Duration = Duration::from_millis(5);

/// Capacity of the ring in bytes: a minute at 1 kHz.
const CAPACITY: usize = 1 << 22;

/// Longest wait for the disk.
const FINISH_LIMIT: Duration = Duration::from_secs(30);

/// What the loop does when the ring is full.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhenFull {
    /// It waits for the disk; its clock pauses meanwhile.
    Wait,
    /// It continues and the capture fails; its clock can't pause.
    Fail,
}

/// The link's end of a capture. Dropping it writes what is pending and closes the file.
#[derive(Debug)]
pub struct Recorder {
    /// `None` at the very end.
    ring: Option<Producer<u8>>,
    /// When the capture began, on the calendar and on the clock that never jumps.
    began: (u64, Instant),
    when_full: WhenFull,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// The user's end of a capture.
#[derive(Debug)]
pub struct Capture(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    /// `state` has an error to report.
    failed: AtomicBool,
    /// The ring was full.
    overflowed: AtomicBool,
    state: Mutex<State>,
    changed: Condvar,
    path: Box<Path>,
}

#[derive(Debug, Default)]
struct State {
    error: Option<WriteError>,
    /// Packets in the file, once it is closed.
    packets: Option<u64>,
}

/// Creates the file, or empties it, and starts the thread that writes it.
///
/// # Errors
/// The file can't be created or written, or the system refused the thread.
pub fn create(path: &Path, when_full: WhenFull) -> Result<(Recorder, Capture), WriteError> {
    with_room(path, when_full, CAPACITY)
}

fn with_room(path: &Path, when_full: WhenFull, room: usize) -> Result<(Recorder, Capture), WriteError> {
    let mut file = CaptureFile::create(path)?;
    let (mut ring, mut packets) = RingBuffer::new(room);
    touch(&mut ring, &mut packets);
    let shared = Arc::new(Shared {
        failed: AtomicBool::new(false),
        overflowed: AtomicBool::new(false),
        state: Mutex::default(),
        changed: Condvar::new(),
        path: path.into(),
    });
    let (told, began) = (Arc::clone(&shared), now());
    let write = move || keep_writing(&mut file, &mut packets, &told);
    let thread = thread::Builder::new().name("capture".to_owned()).spawn(write);
    let thread = thread.map_err(|source| shared.error("written", source))?;
    let capture = Capture(Arc::clone(&shared));
    Ok((Recorder { ring: Some(ring), began, when_full, shared, thread: Some(thread) }, capture))
}

fn now() -> (u64, Instant) {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since_1970.as_nanos() as u64, Instant::now())
}

/// Has every page of the ring in memory before the loop begins.
fn touch(ring: &mut Producer<u8>, packets: &mut Consumer<u8>) {
    if let Ok(all) = ring.write_chunk_uninit(ring.buffer().capacity()) {
        all.fill_from_iter(std::iter::repeat(0));
    }
    if let Ok(all) = packets.read_chunk(packets.slots()) {
        all.commit_all();
    }
}

/// What stands before the bytes of a packet in the ring.
struct Header {
    time_ns: u64,
    direction: Direction,
    len: u16,
}

impl Header {
    const LEN: usize = 11;

    fn bytes(&self) -> [u8; Self::LEN] {
        let mut bytes = [0; Self::LEN];
        bytes[..8].copy_from_slice(&self.time_ns.to_le_bytes());
        bytes[8] = u8::from(self.direction == Direction::DriveToHost);
        bytes[9..].copy_from_slice(&self.len.to_le_bytes());
        bytes
    }

    /// Takes one off the front.
    fn split_off(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (time, rest) = bytes.split_first_chunk()?;
        let (&[direction], rest) = rest.split_first_chunk()?;
        let (len, rest) = rest.split_first_chunk()?;
        let direction = if direction == 0 { Direction::HostToDrive } else { Direction::DriveToHost };
        Some((Self { time_ns: u64::from_le_bytes(*time), direction, len: u16::from_le_bytes(*len) }, rest))
    }
}

impl Recorder {
    /// Takes a piece of the line as a packet of this moment. A capture that has failed takes nothing more;
    /// [`Capture::check`] tells.
    pub fn push(&mut self, direction: Direction, bytes: &[u8]) {
        let Some(ring) = &mut self.ring else { return };
        let (calendar_ns, instant) = self.began;
        let time_ns = calendar_ns + instant.elapsed().as_nanos() as u64;
        for piece in bytes.chunks(u16::MAX.into()) {
            let header = Header { time_ns, direction, len: piece.len() as u16 }.bytes();
            let needed = header.len() + piece.len();
            let give_up = Instant::now() + FINISH_LIMIT;
            while self.when_full == WhenFull::Wait
                && ring.slots() < needed
                && !ring.is_abandoned()
                && Instant::now() < give_up
            {
                if let Some(thread) = &self.thread {
                    thread.thread().unpark();
                }
                thread::sleep(Duration::from_micros(100));
            }
            // After a gap nothing more is taken, or the gap would be one that nobody sees.
            match ring.write_chunk_uninit(needed) {
                Ok(room) if !self.shared.overflowed.load(Ordering::Relaxed) => {
                    room.fill_from_iter(header.into_iter().chain(piece.iter().copied()));
                }
                _ => self.shared.overflowed.store(true, Ordering::Relaxed),
            }
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // The thread ends when the ring has nobody left to fill it.
        drop(self.ring.take());
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // One whose disk hangs is left alone; `Capture::finish` tells.
            let give_up = Instant::now() + FINISH_LIMIT;
            while !thread.is_finished() && Instant::now() < give_up {
                thread::sleep(Duration::from_micros(100));
            }
        }
    }
}

impl Capture {
    /// Whether the file takes what it is given; an error is told once.
    ///
    /// # Errors
    /// It does not; what it had taken before is whole.
    pub fn check(&self) -> Result<(), WriteError> {
        let shared = &self.0;
        if shared.overflowed.load(Ordering::Relaxed) {
            let reason = format!("the disk is {} MiB behind the line; write to a faster one", CAPACITY >> 20);
            return Err(shared.error("written", io::Error::other(reason)));
        }
        if shared.failed.swap(false, Ordering::Relaxed) {
            return shared.state().error.take().map_or(Ok(()), Err);
        }
        Ok(())
    }

    /// Waits until everything is in the file and gives the number of packets. The [`Recorder`] has to be gone by then.
    ///
    /// # Errors
    /// The file did not take everything, or not in time.
    pub fn finish(&self) -> Result<u64, WriteError> {
        let waiting = |state: &mut State| state.packets.is_none();
        let (state, _) = self
            .0
            .changed
            .wait_timeout_while(self.0.state(), FINISH_LIMIT, waiting)
            .unwrap_or_else(PoisonError::into_inner);
        let packets = state.packets;
        drop(state);
        self.check()?;
        packets.ok_or_else(|| self.0.error("written", io::ErrorKind::TimedOut.into()))
    }
}

impl Shared {
    /// A thread that panicked has left it whole.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn error(&self, action: &'static str, source: io::Error) -> WriteError {
        WriteError { path: self.path.to_path_buf(), action, source }
    }
}

/// Empties the ring into the file until nobody fills it any more.
fn keep_writing(file: &mut CaptureFile, packets: &mut Consumer<u8>, shared: &Shared) {
    let mut pending = Vec::new();
    loop {
        // Looked at first: what was put into the ring before its end is still taken.
        let ended = packets.is_abandoned();
        if let Ok(chunk) = packets.read_chunk(packets.slots()) {
            let (first, second) = chunk.as_slices();
            pending.extend_from_slice(first);
            pending.extend_from_slice(second);
            chunk.commit_all();
        }
        let mut rest = &pending[..];
        while let Some((header, after)) = Header::split_off(rest) {
            let (packet, after) = after.split_at(usize::from(header.len).min(after.len()));
            file.push(header.time_ns, header.direction, packet);
            rest = after;
        }
        pending.clear();
        if let Err(error) = file.flush() {
            shared.state().error = Some(error);
            shared.failed.store(true, Ordering::Relaxed);
        }
        if ended {
            let mut state = shared.state();
            state.packets = Some(file.packets());
            shared.changed.notify_all();
            return;
        }
        thread::park_timeout(FLUSH);
    }
}

#[cfg(test)]
mod tests;
