//! The far end of the link: bytes in device time, each as long as the USART's divider makes it.

use std::collections::VecDeque;
use std::time::Duration;

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;

/// The far end of the line.
#[derive(Debug, Default)]
pub struct SerialLine {
    to_chip: VecDeque<u8>,
    from_chip: Vec<u8>,
    last_byte_at: Duration,
    /// When the chip's last byte ended, and the shortest time between the ends of two.
    from_chip_at: Option<Duration>,
    shortest_byte: Option<Duration>,
}

impl SerialLine {
    /// Queues bytes for the chip.
    pub fn send(&mut self, bytes: &[u8]) {
        self.to_chip.extend(bytes);
    }

    /// Bytes that the chip's receiver has not taken yet.
    #[must_use]
    pub fn unsent(&self) -> usize {
        self.to_chip.len()
    }

    /// Bytes that the chip has sent and that were not taken.
    #[must_use]
    pub fn received(&self) -> &[u8] {
        &self.from_chip
    }

    /// Takes what the chip has sent.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.from_chip)
    }

    /// Discards the bytes of both directions.
    pub fn clear(&mut self) {
        self.to_chip.clear();
        self.from_chip.clear();
    }

    /// The shortest time between the ends of two bytes of the chip: that of a byte.
    #[must_use]
    pub fn shortest_byte(&self) -> Option<Duration> {
        self.shortest_byte
    }

    /// Device time of the last byte in either direction.
    #[must_use]
    pub fn last_byte_at(&self) -> Duration {
        self.last_byte_at
    }
}

impl Store for SerialLine {}

impl Peer for SerialLine {
    fn receive(&mut self, word: u16, context: &mut Timeline<'_, '_>) {
        let now = Duration::from_nanos(context.now().0);
        self.last_byte_at = now;
        if let Some(before) = self.from_chip_at.replace(now) {
            let byte = now.saturating_sub(before);
            self.shortest_byte = Some(self.shortest_byte.map_or(byte, |shortest| shortest.min(byte)));
        }
        // The image sets 8 data bits: the upper byte of a word is 0.
        self.from_chip.push(word as u8);
    }

    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        let byte = self.to_chip.pop_front()?;
        self.last_byte_at = Duration::from_nanos(now.0);
        Some(byte.into())
    }
}
