//! The transmit buffer.

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

    /// Appends a whole frame. A frame that does not fit is omitted, never cut; the reserve that
    /// [`Self::fits_an_answer`] checks guarantees that answers fit.
    pub(super) fn send(&mut self, message: impl Into<DriveMessage>) {
        self.append(&message.into());
    }

    /// As [`Self::send`], but encoded with the next answer or for the transmission: in a tick it would cost a quarter of the
    /// control step, and delay the power stage.
    pub(super) fn send_later(&mut self, message: impl Into<DriveMessage>) {
        if self.deferred.is_full() {
            self.encode_deferred();
        }
        let _ = self.deferred.push(message.into());
    }

    #[inline(never)]
    fn encode_deferred(&mut self) {
        let Self { bytes, deferred } = self;
        deferred.iter().for_each(|message| encode(bytes, message));
        deferred.clear();
    }

    /// One function for all messages: an encoder per message type would cost the image a kilobyte.
    fn append(&mut self, message: &DriveMessage) {
        self.encode_deferred();
        encode(&mut self.bytes, message);
    }

    /// Appends a log line, unless it would displace an answer.
    pub(super) fn log(&mut self, level: LogLevel, pieces: &[&str]) {
        if self.fits_an_answer() {
            let mut text = Text::EMPTY;
            pieces.iter().for_each(|piece| text.push(piece));
            self.send(Log { level, text });
        }
    }
}

#[inline(never)]
fn encode(bytes: &mut heapless::Vec<u8, CAPACITY>, message: &DriveMessage) {
    let _ = bytes.extend_from_slice(&message.frame());
}

/// The fault report of a failed firmware as a whole frame, for panic and fault handlers that can't reach the drive.
#[must_use]
pub fn fault_frame(code: FaultCode, detail: u32) -> Frame {
    Frame::of(&FaultReport { code, sequence: 0, value: 0.0, limit: 0.0, detail })
}
