//! From the loop to the file: a lock-free ring passes packets to a thread that writes them.
//!
//! The loop neither locks nor allocates nor writes for its capture. The thread empties the ring every [`FLUSH`], so that a
//! killed bench loses only the packets of that time. The file holds whole packets at any time. A full ring never loses a
//! packet silently: in lockstep the loop waits for the disk; in real time, where it can't, the run ends with an error.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use lashloop_protocol::layout::Direction;
use rtrb::{Consumer, Producer, RingBuffer};

use super::pcapng;
use super::splitter::LONGEST;
use lashloop_bench::atomic_file::{GrowingFile, WriteError};

/// How often packets reach the file.
pub const FLUSH: Duration = Duration::from_millis(5);

/// Capacity of the ring in bytes: half a minute at 1 kHz.
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
    /// `None` only while the recorder is dropped.
    ring: Option<Producer<u8>>,
    /// The latest packet as a block of the file.
    block: Vec<u8>,
    /// The start of the capture: in nanoseconds since the start of 1970, and on the monotonic clock.
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
    /// A write has failed; nothing more is written.
    failed: AtomicBool,
    /// The ring was full.
    overflowed: AtomicBool,
    packets: AtomicU64,
    state: Mutex<State>,
    changed: Condvar,
    path: Box<Path>,
}

#[derive(Debug, Default)]
struct State {
    error: Option<WriteError>,
    /// Everything is written.
    ended: bool,
}

/// Creates the file, or empties it, and starts the thread that writes it.
///
/// # Errors
/// The file can't be created or written, or the system refused the thread.
pub fn create(path: &Path, when_full: WhenFull) -> Result<(Recorder, Capture), WriteError> {
    with_capacity(path, when_full, CAPACITY)
}

fn with_capacity(
    path: &Path,
    when_full: WhenFull,
    capacity: usize,
) -> Result<(Recorder, Capture), WriteError> {
    let mut file = GrowingFile::create(path, ".capture-", &pcapng::file_header())?;
    let (mut ring, mut blocks) = RingBuffer::new(capacity);
    touch(&mut ring, &mut blocks);
    let shared = Arc::new(Shared {
        failed: AtomicBool::new(false),
        overflowed: AtomicBool::new(false),
        packets: AtomicU64::new(0),
        state: Mutex::default(),
        changed: Condvar::new(),
        path: path.into(),
    });
    let of_thread = Arc::clone(&shared);
    let write = move || keep_writing(&mut file, &mut blocks, &of_thread);
    let thread = thread::Builder::new().name("capture".to_owned()).spawn(write);
    let thread = thread.map_err(|source| shared.error("written", source))?;
    tracing::debug!(thread = "capture", file = %shared.path.display(), "started");
    let capture = Capture(Arc::clone(&shared));
    // With a capacity for the longest piece and its block, so that no packet allocates.
    let block = Vec::with_capacity(LONGEST + 64);
    Ok((Recorder { ring: Some(ring), block, began: now(), when_full, shared, thread: Some(thread) }, capture))
}

fn now() -> (u64, Instant) {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    (since_1970.as_nanos() as u64, Instant::now())
}

/// Maps every page of the ring before the loop begins.
fn touch(ring: &mut Producer<u8>, blocks: &mut Consumer<u8>) {
    if let Ok(all) = ring.write_chunk_uninit(ring.buffer().capacity()) {
        all.fill_from_iter(std::iter::repeat(0));
    }
    if let Ok(all) = blocks.read_chunk(blocks.slots()) {
        all.commit_all();
    }
}

impl Recorder {
    /// Records a piece of the line as a packet of the present time. A capture that has failed records nothing more;
    /// [`Capture::check`] reports the failure.
    pub fn push(&mut self, direction: Direction, bytes: &[u8]) {
        let Some(ring) = &mut self.ring else { return };
        let (calendar_ns, instant) = self.began;
        let time_ns = calendar_ns + instant.elapsed().as_nanos() as u64;
        self.block.clear();
        pcapng::append_packet(&mut self.block, time_ns, direction, bytes);
        let give_up = Instant::now() + FINISH_LIMIT;
        while self.when_full == WhenFull::Wait
            && ring.slots() < self.block.len()
            && !ring.is_abandoned()
            && Instant::now() < give_up
        {
            if let Some(thread) = &self.thread {
                thread.thread().unpark();
            }
            thread::sleep(Duration::from_micros(100));
        }
        // After a lost packet no packet is recorded: the file would hide the gap.
        match ring.write_chunk_uninit(self.block.len()) {
            Ok(chunk) if !self.shared.overflowed.load(Ordering::Relaxed) => {
                chunk.fill_from_iter(self.block.iter().copied());
                self.shared.packets.fetch_add(1, Ordering::Relaxed);
            }
            _ => self.shared.overflowed.store(true, Ordering::Relaxed),
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // The thread ends when the ring's sending end is dropped.
        drop(self.ring.take());
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // A thread whose disk hangs is left running; `Capture::finish` reports the timeout.
            let give_up = Instant::now() + FINISH_LIMIT;
            while !thread.is_finished() && Instant::now() < give_up {
                thread::sleep(Duration::from_micros(100));
            }
        }
    }
}

impl Capture {
    /// Checks that no packet is lost so far.
    ///
    /// # Errors
    /// The ring was full or the file can't be written. The packets written before are whole.
    pub fn check(&self) -> Result<(), WriteError> {
        let shared = &self.0;
        if shared.overflowed.load(Ordering::Relaxed) {
            let reason = format!("the disk is {} MiB behind the line; write to a faster one", CAPACITY >> 20);
            return Err(shared.error("written", io::Error::other(reason)));
        }
        if shared.failed.load(Ordering::Relaxed) {
            let lost = || shared.error("written", io::Error::other("packets are missing"));
            return Err(shared.state().error.take().unwrap_or_else(lost));
        }
        Ok(())
    }

    /// Waits until all packets are written and returns their number. The [`Recorder`] must be dropped before.
    ///
    /// # Errors
    /// A packet is missing in the file, or the disk is too slow.
    pub fn finish(&self) -> Result<u64, WriteError> {
        let waiting = |state: &mut State| !state.ended;
        let (state, _) = self
            .0
            .changed
            .wait_timeout_while(self.0.state(), FINISH_LIMIT, waiting)
            .unwrap_or_else(PoisonError::into_inner);
        let ended = state.ended;
        drop(state);
        self.check()?;
        if !ended {
            return Err(self.0.error("written", io::ErrorKind::TimedOut.into()));
        }
        Ok(self.0.packets.load(Ordering::Relaxed))
    }
}

impl Shared {
    /// A thread that panicked leaves the state consistent.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn error(&self, action: &'static str, source: io::Error) -> WriteError {
        WriteError { path: self.path.to_path_buf(), action, source }
    }
}

/// Empties the ring into the file until the ring's sending end is dropped.
fn keep_writing(file: &mut GrowingFile, blocks: &mut Consumer<u8>, shared: &Shared) {
    let mut pending = Vec::new();
    loop {
        // Read before the ring: blocks that precede the end are still written.
        let ended = blocks.is_abandoned();
        if let Ok(chunk) = blocks.read_chunk(blocks.slots()) {
            let (first, second) = chunk.as_slices();
            pending.extend_from_slice(first);
            pending.extend_from_slice(second);
            chunk.commit_all();
        }
        if !shared.failed.load(Ordering::Relaxed)
            && let Err(error) = file.append(&pending)
        {
            shared.state().error = Some(error);
            shared.failed.store(true, Ordering::Relaxed);
        }
        pending.clear();
        if ended {
            shared.state().ended = true;
            shared.changed.notify_all();
            return;
        }
        thread::park_timeout(FLUSH);
    }
}

#[cfg(test)]
mod tests;
