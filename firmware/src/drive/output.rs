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
    /// Not encoded yet, see [`Self::send_later`].
    deferred: Option<FaultReport>,
}

impl Output {
    pub(super) fn bytes(&mut self) -> &[u8] {
        self.encode_deferred();
        &self.bytes
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty() && self.deferred.is_none()
    }

    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.deferred = None;
    }

    pub(super) fn fits_an_answer(&mut self) -> bool {
        self.encode_deferred();
        self.bytes.len() + LONGEST_ANSWER <= CAPACITY
    }

    /// Appends a whole frame. A frame that does not fit is omitted, never cut; the reserve that
    /// [`Self::fits_an_answer`] checks guarantees that answers fit.
    pub(super) fn send(&mut self, message: impl Into<DriveMessage>) {
        self.append(&message.into());
    }

    /// As [`Self::send`], but encoded by whoever takes the output or sends the next message: encoding costs a quarter of a
    /// control step, and the power stage goes off first.
    pub(super) fn send_later(&mut self, report: FaultReport) {
        self.encode_deferred();
        self.deferred = Some(report);
    }

    fn encode_deferred(&mut self) {
        if let Some(report) = self.deferred.take() {
            self.append(&report.into());
        }
    }

    /// One function for all messages: an encoder per message type would cost the image a kilobyte.
    fn append(&mut self, message: &DriveMessage) {
        self.encode_deferred();
        let _ = self.bytes.extend_from_slice(&message.frame());
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

/// The fault report of a failed firmware as a whole frame, for panic and fault handlers that can't reach the drive.
#[must_use]
pub fn fault_frame(code: FaultCode, detail: u32) -> Frame {
    Frame::of(&FaultReport { code, sequence: 0, value: 0.0, limit: 0.0, detail })
}
