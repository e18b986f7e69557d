//! A line between a bench and a drive that somebody tampers with.
//!
//! The relay sits between two pseudo-terminals and hands every frame that passes to a function, which says what becomes
//! of it. So a fault hits a frame chosen by its contents, and a test is the same test every time.

use std::fs::File;
use std::io::{self, PipeWriter, Read, Write};
use std::path::Path;
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::Instant;

use lashloop_protocol::message::{EncoderSample, TorqueAnswer};
use lashloop_protocol::{Decoder, DriveMessage, HostMessage, Message};
use rustix::event::{PollFd, PollFlags, poll};

use crate::terminal::{self, open_near_end};
use crate::wait::SOON;

/// Who sent a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sender {
    /// The bench.
    Bench,
    /// The drive.
    Drive,
}

/// A frame on its way, or a lone delimiter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Passing {
    /// Who sent it.
    pub sender: Sender,
    /// Its bytes, the delimiter at the end included.
    pub bytes: Vec<u8>,
}

impl Passing {
    /// The sample in it, if it is one.
    #[must_use]
    pub fn sample(&self) -> Option<EncoderSample> {
        match self.from_bench()? {
            HostMessage::EncoderSample(sample) => Some(sample),
            _ => None,
        }
    }

    /// The message of the drive in it, if it is one.
    #[must_use]
    pub fn from_drive(&self) -> Option<DriveMessage> {
        if self.sender == Sender::Drive { self.read() } else { None }
    }

    /// The message of the bench in it, if it is one.
    #[must_use]
    pub fn from_bench(&self) -> Option<HostMessage> {
        if self.sender == Sender::Bench { self.read() } else { None }
    }

    /// The torque in it, if it is one.
    #[must_use]
    pub fn torque(&self) -> Option<TorqueAnswer> {
        match self.from_drive()? {
            DriveMessage::TorqueAnswer(answer) => Some(answer),
            _ => None,
        }
    }

    fn read<M: Message>(&self) -> Option<M> {
        Decoder::new().next(&mut &self.bytes[..])?.ok()
    }
}

/// What becomes of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StepOutcome {
    /// It arrives.
    Pass,
    /// These bytes arrive in its place.
    Become(Vec<u8>),
    /// The bench's terminal is pulled, and the frame with it.
    Pull,
}

/// A running relay. Dropping it ends it.
pub struct Relay {
    device: String,
    pulled: mpsc::Receiver<Instant>,
    stop: Option<PipeWriter>,
    thread: Option<JoinHandle<()>>,
}

impl Relay {
    /// Puts a relay before the terminal of a drive.
    ///
    /// # Panics
    /// The terminal is not there.
    pub fn start(drive: &Path, tamper: impl FnMut(&Passing) -> StepOutcome + Send + 'static) -> Self {
        let terminal = terminal::open();
        let device = terminal::device(&terminal);
        let far_end = File::from(terminal.far_end.try_clone().expect("a handle"));
        let drive = open_near_end(drive);
        let (stopped, stop) = io::pipe().expect("a pipe");
        let (tell, pulled) = mpsc::channel();
        let thread = thread::spawn(move || {
            if carry(&far_end, &drive, &stopped, tamper).expect("the relay's terminals work") {
                drop((far_end, terminal));
                let _ = tell.send(Instant::now());
            }
        });
        Self { device, pulled, stop: Some(stop), thread: Some(thread) }
    }

    /// The relay's terminal as `--device` takes it.
    #[must_use]
    pub fn device(&self) -> &str {
        &self.device
    }

    /// When the line was pulled.
    ///
    /// # Panics
    /// It wasn't.
    #[must_use]
    pub fn pulled_at(&self) -> Instant {
        self.pulled.recv_timeout(SOON).expect("the relay pulls the line")
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        drop(self.stop.take());
        let failed = self.thread.take().is_some_and(|thread| thread.join().is_err());
        assert!(!failed || thread::panicking(), "the relay failed");
    }
}

/// Carries frames both ways until it is stopped (`false`) or has to pull the line (`true`).
fn carry(
    bench: &File,
    drive: &File,
    stopped: &io::PipeReader,
    mut tamper: impl FnMut(&Passing) -> StepOutcome,
) -> io::Result<bool> {
    let mut ways = [
        Way { sender: Sender::Bench, from: bench, to: drive, begun: Vec::new() },
        Way { sender: Sender::Drive, from: drive, to: bench, begun: Vec::new() },
    ];
    loop {
        let mut ends = [
            PollFd::new(bench, PollFlags::IN),
            PollFd::new(drive, PollFlags::IN),
            PollFd::new(stopped, PollFlags::IN),
        ];
        poll(&mut ends, None)?;
        let [bench_has, drive_has, told] = ends.map(|end| end.revents());
        if !told.is_empty() {
            return Ok(false);
        }
        for (way, has) in ways.iter_mut().zip([bench_has, drive_has]) {
            if !has.is_empty() && way.carry(&mut tamper)? {
                return Ok(true);
            }
        }
    }
}

struct Way<'a> {
    sender: Sender,
    from: &'a File,
    to: &'a File,
    /// What has come of a frame that is not complete.
    begun: Vec<u8>,
}

impl Way<'_> {
    /// Whether the line is to be pulled.
    fn carry(&mut self, tamper: &mut impl FnMut(&Passing) -> StepOutcome) -> io::Result<bool> {
        let mut buffer = [0; 4096];
        let count = self.from.read(&mut buffer)?;
        // A drive that is gone closes its terminal; the bench is to see the same.
        if count == 0 {
            return Ok(true);
        }
        let mut out = Vec::new();
        for &byte in &buffer[..count] {
            self.begun.push(byte);
            if byte != 0 {
                continue;
            }
            let frame = Passing { sender: self.sender, bytes: std::mem::take(&mut self.begun) };
            match tamper(&frame) {
                StepOutcome::Pass => out.extend(frame.bytes),
                StepOutcome::Become(bytes) => out.extend(bytes),
                StepOutcome::Pull => return Ok(true),
            }
        }
        self.to.write_all(&out)?;
        Ok(false)
    }
}
