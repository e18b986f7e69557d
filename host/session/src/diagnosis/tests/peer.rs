//! A scripted far end with a clock of its own.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use lashloop_protocol::enums::{Capabilities, State, Version};
use lashloop_protocol::message::Identity;
use lashloop_protocol::text::Text;
use lashloop_protocol::{Decoder, HostMessage, Numbered};

use lashloop_link::{Link, LinkError};

/// Bytes that arrive, each after a delay from the one before.
pub type Reply = Vec<(Duration, Vec<u8>)>;

type Replies = Box<dyn FnMut(&[u8]) -> Reply + Send>;
type Pieces = Box<dyn FnMut() -> Vec<u8> + Send>;

/// A far end that replies to each write, and sends its stream without being asked.
pub struct Peer {
    pub now: Instant,
    replies: Replies,
    stream: Option<(Duration, Pieces)>,
    pending: VecDeque<(Instant, Vec<u8>)>,
}

impl Peer {
    /// A far end that replies to each write.
    pub fn replying(replies: impl FnMut(&[u8]) -> Reply + Send + 'static) -> Self {
        let replies = Box::new(replies);
        Self { now: Instant::now(), replies, stream: None, pending: VecDeque::new() }
    }

    /// A far end that answers each request with one frame, `delay` later.
    pub fn answering(
        delay: Duration,
        mut answer: impl FnMut(Numbered<HostMessage>) -> Option<Vec<u8>> + Send + 'static,
    ) -> Self {
        Self::answering_after(move |request| Some((delay, answer(request)?)))
    }

    /// A far end that answers each request with one frame, after a delay that depends on the request.
    pub fn answering_after(
        mut answer: impl FnMut(Numbered<HostMessage>) -> Option<(Duration, Vec<u8>)> + Send + 'static,
    ) -> Self {
        Self::replying(move |bytes| {
            let (mut bytes, mut decoder) = (bytes, Decoder::new());
            let requests = std::iter::from_fn(|| decoder.next::<HostMessage>(&mut bytes));
            requests.flatten().filter_map(&mut answer).collect()
        })
    }

    /// A far end that sends a piece at each interval and reads nothing.
    pub fn streaming(interval: Duration, piece: impl FnMut() -> Vec<u8> + Send + 'static) -> Self {
        let stream = Some((interval, Box::new(piece) as Pieces));
        Self { stream, ..Self::replying(|_| Vec::new()) }
    }
}

impl Link for Peer {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn now(&mut self) -> Instant {
        self.now
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let mut at = self.pending.back().map_or(self.now, |(at, _)| self.now.max(*at));
        for (delay, bytes) in (self.replies)(bytes) {
            at += delay;
            self.pending.push_back((at, bytes));
        }
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        if let (Some((interval, piece)), true) = (&mut self.stream, self.pending.is_empty()) {
            self.pending.push_back((self.now + *interval, piece()));
        }
        match self.pending.front_mut() {
            Some((at, bytes)) if *at <= self.now.max(deadline) => {
                self.now = self.now.max(*at);
                let count = bytes.len().min(buffer.len());
                buffer[..count].copy_from_slice(&bytes[..count]);
                bytes.drain(..count);
                if bytes.is_empty() {
                    self.pending.pop_front();
                }
                Ok(count)
            }
            _ => {
                self.now = self.now.max(deadline);
                Ok(0)
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.pending.clear();
        Ok(())
    }
}

/// The identity of a drive that describes nothing.
pub fn identity(session: u32) -> Identity {
    Identity {
        protocol_version: 1,
        minor_version: 0,
        session,
        firmware: Version { major: 1, minor: 0, patch: 0 },
        build_id: 0,
        dirty: 0,
        state: State::Idle,
        board: Text::new("peer"),
        period_us: 1000,
        motor_counts_per_rev: 4096,
        load_counts_per_rev: 4096,
        law_count: 1,
        signal_count: 0,
        parameter_count: 0,
        capabilities: Capabilities::empty(),
        device_time_us: None,
    }
}

/// The bytes that a UART receives which samples `ratio` times as fast as `sent` is sent.
pub fn sampled(sent: &[u8], ratio: f64) -> Vec<u8> {
    let idle = [true; 20];
    let frame = |byte: &u8| {
        let byte = *byte;
        std::iter::once(false).chain((0..8).map(move |bit| byte >> bit & 1 == 1)).chain([true])
    };
    let line: Vec<bool> = idle.into_iter().chain(sent.iter().flat_map(frame)).chain(idle).collect();
    // Time in bits of the sender.
    let level = |time: f64| line.get(time as usize).copied().unwrap_or(true);
    let (mut received, mut time, bit) = (Vec::new(), 0.0, 1.0 / ratio);
    while time < line.len() as f64 {
        if level(time) {
            time += bit / 16.0;
            continue;
        }
        // The middle of each bit after the start bit.
        let bits = (0..8).map(|n| u8::from(level(time + bit * (1.5 + f64::from(n)))) << n);
        received.push(bits.sum());
        time += bit * 9.5;
    }
    received
}
