//! What the drive wants sent.

use lashloop_protocol::enums::LogLevel;
use lashloop_protocol::message::Log;
use lashloop_protocol::text::Text;
use lashloop_protocol::{DriveMessage, MAX_FRAME, Message};

/// One sample can cause a torque, a telemetry and a fault; one request an identity and a fault. A tick can add a fault.
const LONGEST_ANSWER: usize = 3 * MAX_FRAME;
const CAPACITY: usize = 2 * LONGEST_ANSWER;

#[derive(Default)]
pub(super) struct Output {
    bytes: heapless::Vec<u8, CAPACITY>,
}

impl Output {
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn clear(&mut self) {
        self.bytes.clear();
    }

    pub(super) fn has_room_for_an_answer(&self) -> bool {
        self.bytes.len() + LONGEST_ANSWER <= CAPACITY
    }

    /// Whole frames only: one that does not fit is left out rather than cut, and the room kept by
    /// [`Self::has_room_for_an_answer`] sees to it that answers fit.
    pub(super) fn send(&mut self, message: impl Into<DriveMessage>) {
        let _ = self.bytes.extend_from_slice(&message.into().frame());
    }

    pub(super) fn log(&mut self, level: LogLevel, pieces: &[&str]) {
        if self.has_room_for_an_answer() {
            let mut text = Text::EMPTY;
            pieces.iter().for_each(|piece| text.push(piece));
            self.send(Log { level, text });
        }
    }
}
