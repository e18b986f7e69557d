//! The transmit buffer: what is sent gets its number and its device time here.

use core::time::Duration;

use lashloop_protocol::enums::{FaultCode, LogLevel};
use lashloop_protocol::message::{FaultReport, Log};
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, Frame, MAX_FRAME, Message};

/// Reserve for the answers to one received frame: at most three frames.
const LONGEST_ANSWER: usize = 3 * MAX_FRAME;
const CAPACITY: usize = 2 * LONGEST_ANSWER;

#[derive(Default)]
pub(super) struct Output {
    bytes: heapless::Vec<u8, CAPACITY>,
    /// Not encoded yet, see [`Self::send_later`]: the report of a step, its telemetry, and that of a fault.
    deferred: heapless::Vec<DriveMessage, 3>,
    /// Number of the request that is being answered.
    number: u8,
    /// The latest device time that the drive was told.
    now: Duration,
}

impl Output {
    pub(super) fn bytes(&mut self) -> &[u8] {
        self.encode_deferred();
        &self.bytes
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty() && self.deferred.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.deferred.clear();
    }

    pub(super) fn fits_an_answer(&self) -> bool {
        self.bytes.len() + self.deferred.len() * MAX_FRAME + LONGEST_ANSWER <= CAPACITY
    }

    /// What is sent from here on answers the request of this number, which arrived at `now`.
    pub(super) fn begin_answer(&mut self, number: u8, now: Duration) {
        self.number = number;
        self.note_time(now);
    }

    /// Notes the device time for what is sent from here on. It never runs backwards.
    pub(super) fn note_time(&mut self, now: Duration) {
        self.now = self.now.max(now);
    }

    /// Appends a whole frame. A frame that does not fit is omitted, never cut; the reserve that
    /// [`Self::fits_an_answer`] checks guarantees that answers fit.
    pub(super) fn send(&mut self, message: impl Into<DriveMessage>) {
        self.append(message.into());
    }

    /// As [`Self::send`], but encoded with the next answer or for the transmission: in a tick it would cost a quarter of the
    /// control step, and delay the power stage.
    pub(super) fn send_later(&mut self, message: impl Into<DriveMessage>) {
        if self.deferred.is_full() {
            self.encode_deferred();
        }
        // Before it is pushed: of the report of a step nothing remains of this.
        let mut message = message.into();
        self.stamp(&mut message);
        let _ = self.deferred.push(message);
    }

    #[inline(never)]
    fn encode_deferred(&mut self) {
        let Self { bytes, deferred, .. } = self;
        // None of these kinds has a number.
        deferred.iter().for_each(|message| encode(bytes, message, 0));
        deferred.clear();
    }

    /// One function for all messages: an encoder per message type would cost the image a kilobyte.
    fn append(&mut self, mut message: DriveMessage) {
        self.encode_deferred();
        self.stamp(&mut message);
        encode(&mut self.bytes, &message, self.number);
    }

    /// Writes the device time into a message that has a field for it.
    fn stamp(&self, message: &mut DriveMessage) {
        if let Some(field) = message.device_time_us_mut() {
            *field = Some(device_time_us(self.now));
        }
    }

    /// Appends a log line, unless it would displace an answer.
    pub(super) fn log(&mut self, level: LogLevel, pieces: &[&str]) {
        if self.fits_an_answer() {
            let mut text = Text::EMPTY;
            pieces.iter().for_each(|piece| text.push(piece));
            self.send(Log { level, text, device_time_us: None });
        }
    }
}

#[inline(never)]
fn encode(bytes: &mut heapless::Vec<u8, CAPACITY>, message: &DriveMessage, number: u8) {
    let _ = bytes.extend_from_slice(&message.numbered_frame(number));
}

/// Device time in us, modulo 2^32. In 32-bit arithmetic: a microcontroller divides 64 bits in software.
fn device_time_us(now: Duration) -> u32 {
    (now.as_secs() as u32).wrapping_mul(1_000_000).wrapping_add(now.subsec_micros())
}

/// The fault report of a failed firmware at device time `now` as a whole frame, for panic and fault handlers that can't
/// reach the drive.
#[must_use]
pub fn fault_frame(code: FaultCode, detail: u32, now: Duration) -> Frame {
    let device_time_us = Some(device_time_us(now));
    Frame::of(&FaultReport { code, sequence: 0, value: 0.0, limit: 0.0, detail, device_time_us })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn device_time_wraps_after_71_minutes() {
        let us = |us| device_time_us(Duration::from_micros(us));
        assert_eq!([us(0), us(1_234_567_890), us(1 << 32), us((3 << 32) + 5)], [0, 1_234_567_890, 0, 5]);
        assert_eq!(device_time_us(Duration::from_nanos(1_999)), 1);
    }

    #[test]
    fn a_time_before_the_latest_one_changes_nothing() {
        let mut output = Output::default();
        output.note_time(Duration::from_micros(7));
        output.begin_answer(3, Duration::from_micros(5));
        assert_eq!(output.now, Duration::from_micros(7));
    }
}
