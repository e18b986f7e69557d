//! The line between a test's host and its drive, with what holds for every answer: the number of its request, and device time.

use lashloop_firmware::drive::Drive;
use lashloop_firmware::law::LawSet;
use lashloop_protocol::enums::{Outcome, State};
use lashloop_protocol::layout::has_number;
use lashloop_protocol::{Decoder, DriveMessage, Frame, HostMessage, Message, Numbered};

/// Numbers of the requests, and the latest device time received.
#[derive(Default)]
pub struct Line {
    number: u8,
    latest_us: u32,
}

impl Line {
    /// The frame of the next request.
    pub fn request(&mut self, message: &HostMessage) -> Frame {
        self.number = self.number % u8::MAX + 1;
        message.numbered_frame(self.number)
    }

    /// Takes the output of a drive: whole frames, none with an earlier device time than one before it.
    pub fn take<L: LawSet>(&mut self, drive: &mut Drive<L>) -> Vec<Numbered<DriveMessage>> {
        let mut decoder = Decoder::new();
        let mut bytes = drive.output();
        let messages: Vec<_> =
            std::iter::from_fn(|| decoder.next(&mut bytes)).map(|m| m.expect("a good frame")).collect();
        decoder.finish().expect("whole frames");
        drive.clear_output();
        for Numbered { message, .. } in &messages {
            if let Some(device_time_us) = device_time(message) {
                let us = device_time_us.expect("every message with the field has the device time");
                assert!(self.latest_us <= us, "device time runs backwards: {messages:?}");
                self.latest_us = us;
            }
        }
        messages
    }

    /// Requires that answers repeat the number of the last request, and returns the messages alone.
    pub fn answers(&self, message: &HostMessage, answers: Vec<Numbered<DriveMessage>>) -> Vec<DriveMessage> {
        let expected = if has_number(message.layout().kind) { self.number } else { 0 };
        for answer in &answers {
            let number = if has_number(answer.message.layout().kind) { expected } else { 0 };
            assert_eq!(answer.number, number, "{answer:?} answers {message:?}");
        }
        messages(answers)
    }
}

/// The messages without their numbers.
pub fn messages(numbered: Vec<Numbered<DriveMessage>>) -> Vec<DriveMessage> {
    numbered.into_iter().map(|it| it.message).collect()
}

/// Outcome, detail and state of the only answer, a result.
pub fn refusal(answers: &[DriveMessage]) -> (Outcome, u32, State) {
    match answers {
        [DriveMessage::CommandResult(it)] => (it.outcome, it.detail, it.state),
        other => panic!("{other:?}"),
    }
}

/// The device time of a message in us; `None` for one without the field.
pub fn device_time(message: &DriveMessage) -> Option<Option<u32>> {
    { *message }.device_time_us_mut().copied()
}
