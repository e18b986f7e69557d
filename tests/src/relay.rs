//! A line with chosen faults between bench and drive.
//!
//! The relay connects two pseudo-terminals and passes every frame to a function, which returns an [`Action`]. A test can
//! thus select the faulty frame by its contents, so the test is repeatable.

use std::fs::File;
use std::io::{self, PipeWriter, Read, Write};
use std::path::Path;
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::Instant;

use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message, Numbered};
use rustix::event::{PollFd, PollFlags, poll};

use crate::terminal::{self, open_near_end};
use crate::wait::SOON;

/// Sender of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sender {
    /// The bench.
    Bench,
    /// The drive.
    Drive,
}

/// A frame in transit, or a lone delimiter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transit {
    /// Sender.
    pub sender: Sender,
    /// Bytes, with the delimiter at the end.
    pub bytes: Vec<u8>,
}

impl Transit {
    /// The sample, if the frame is one.
    #[must_use]
    pub fn sample(&self) -> Option<EncoderSample> {
        match self.from_bench()? {
            HostMessage::EncoderSample(sample) => Some(sample),
            _ => None,
        }
    }

    /// The message, if the drive sent the frame.
    #[must_use]
    pub fn from_drive(&self) -> Option<DriveMessage> {
        if self.sender == Sender::Drive { self.read() } else { None }
    }

    /// The message, if the bench sent the frame.
    #[must_use]
    pub fn from_bench(&self) -> Option<HostMessage> {
        if self.sender == Sender::Bench { self.read() } else { None }
    }

    /// The torque, if the frame is one.
    #[must_use]
    pub fn torque(&self) -> Option<TorqueAnswer> {
        match self.from_drive()? {
            DriveMessage::TorqueAnswer(answer) => Some(answer),
            _ => None,
        }
    }

    /// Number of the request that the frame is or answers; 0 if it has none.
    #[must_use]
    pub fn number(&self) -> u8 {
        match self.sender {
            Sender::Bench => self.numbered::<HostMessage>().map_or(0, |it| it.number),
            Sender::Drive => self.numbered::<DriveMessage>().map_or(0, |it| it.number),
        }
    }

    /// Sends this message of the drive instead, with the number of the frame.
    #[must_use]
    pub fn replaced(&self, message: impl Into<DriveMessage>) -> Action {
        Action::Replace(message.into().numbered_frame(self.number()).to_vec())
    }

    fn read<M: Message>(&self) -> Option<M> {
        self.numbered().map(|it| it.message)
    }

    fn numbered<M: Message>(&self) -> Option<Numbered<M>> {
        Decoder::new().next(&mut &self.bytes[..])?.ok()
    }
}

/// What the relay does with a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Action {
    /// Forwards the frame.
    Forward,
    /// Sends these bytes instead; none of them drops the frame.
    Replace(Vec<u8>),
    /// Closes the bench's terminal and drops the frame.
    Disconnect,
}

/// A running relay. Dropping it ends it.
pub struct Relay {
    device: String,
    disconnected: mpsc::Receiver<Instant>,
    stop: Option<PipeWriter>,
    thread: Option<JoinHandle<()>>,
}

impl Relay {
    /// Starts a relay ahead of the terminal of a drive.
    ///
    /// # Panics
    /// The terminal is missing.
    pub fn start(drive: &Path, tamper: impl FnMut(&Transit) -> Action + Send + 'static) -> Self {
        let terminal = terminal::open();
        let device = terminal::device(&terminal);
        let far_end = File::from(terminal.far_end.try_clone().expect("a handle"));
        let drive = open_near_end(drive);
        let (stopped, stop) = io::pipe().expect("a pipe");
        let (sender, disconnected) = mpsc::channel();
        let thread = thread::spawn(move || {
            if carry(&far_end, &drive, &stopped, tamper).expect("the relay's terminals work") {
                drop((far_end, terminal));
                let _ = sender.send(Instant::now());
            }
        });
        Self { device, disconnected, stop: Some(stop), thread: Some(thread) }
    }

    /// The relay's terminal as an argument of `--device`.
    #[must_use]
    pub fn device(&self) -> &str {
        &self.device
    }

    /// Time of the disconnection.
    ///
    /// # Panics
    /// The relay does not disconnect in time.
    #[must_use]
    pub fn disconnected_at(&self) -> Instant {
        self.disconnected.recv_timeout(SOON).expect("the relay disconnects the line")
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        drop(self.stop.take());
        let failed = self.thread.take().is_some_and(|thread| thread.join().is_err());
        assert!(!failed || thread::panicking(), "the relay failed");
    }
}

/// Carries frames both ways until the relay is stopped (`false`) or disconnects the line (`true`).
fn carry(
    bench: &File,
    drive: &File,
    stopped: &io::PipeReader,
    mut tamper: impl FnMut(&Transit) -> Action,
) -> io::Result<bool> {
    let mut directions = [
        Direction { sender: Sender::Bench, from: bench, to: drive, partial: Vec::new() },
        Direction { sender: Sender::Drive, from: drive, to: bench, partial: Vec::new() },
    ];
    loop {
        let mut ends = [
            PollFd::new(bench, PollFlags::IN),
            PollFd::new(drive, PollFlags::IN),
            PollFd::new(stopped, PollFlags::IN),
        ];
        poll(&mut ends, None)?;
        let [bench_events, drive_events, stop_events] = ends.map(|end| end.revents());
        if !stop_events.is_empty() {
            return Ok(false);
        }
        for (direction, events) in directions.iter_mut().zip([bench_events, drive_events]) {
            if !events.is_empty() && direction.carry(&mut tamper)? {
                return Ok(true);
            }
        }
    }
}

struct Direction<'a> {
    sender: Sender,
    from: &'a File,
    to: &'a File,
    /// Bytes of an incomplete frame.
    partial: Vec<u8>,
}

impl Direction<'_> {
    /// Forwards what has arrived; true if the line is to be disconnected.
    fn carry(&mut self, tamper: &mut impl FnMut(&Transit) -> Action) -> io::Result<bool> {
        let mut buffer = [0; 4096];
        let count = self.from.read(&mut buffer)?;
        // A drive that ends closes its terminal, and the bench must see its own terminal closed.
        if count == 0 {
            return Ok(true);
        }
        let mut out = Vec::new();
        for &byte in &buffer[..count] {
            self.partial.push(byte);
            if byte != 0 {
                continue;
            }
            let frame = Transit { sender: self.sender, bytes: std::mem::take(&mut self.partial) };
            match tamper(&frame) {
                Action::Forward => out.extend(frame.bytes),
                Action::Replace(bytes) => out.extend(bytes),
                Action::Disconnect => return Ok(true),
            }
        }
        self.to.write_all(&out)?;
        Ok(false)
    }
}
