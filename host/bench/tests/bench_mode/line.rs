//! A line that changes reports of the drive.

use std::time::Instant;

use lashloop_link::{Link, LinkError};
use lashloop_protocol::message::BenchSample;
use lashloop_protocol::{Decoder, DriveMessage, EncoderCounts, Message, Numbered};

/// What becomes of a report.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Action {
    Drop,
    Torque(f32),
    Reference(u16),
    LoadOffset(EncoderCounts),
}

/// Which reports are changed.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Line {
    action: Option<Action>,
    /// The step; `None` for every one.
    step: Option<u16>,
}

impl Line {
    pub(crate) fn at(step: u16, action: Action) -> Self {
        Self { action: Some(action), step: Some(step) }
    }

    pub(crate) fn always(action: Action) -> Self {
        Self { action: Some(action), step: None }
    }

    pub(crate) fn around(self, link: Box<dyn Link>) -> Box<dyn Link> {
        Box::new(Changed { link, line: self, decoder: Decoder::new() })
    }

    /// The message as it arrives; `None` if it is lost.
    fn pass(self, message: DriveMessage) -> Option<DriveMessage> {
        let (DriveMessage::BenchSample(sample), Some(action)) = (message, self.action) else {
            return Some(message);
        };
        if self.step.is_some_and(|step| step != sample.sequence) {
            return Some(message);
        }
        let changed = match action {
            Action::Drop => return None,
            Action::Torque(torque_nm) => BenchSample { torque_nm, ..sample },
            Action::Reference(reference_number) => BenchSample { reference_number, ..sample },
            Action::LoadOffset(offset) => {
                let counts = i64::from(sample.load_counts.get()) + i64::from(offset.get());
                BenchSample { load_counts: EncoderCounts::wrapping(counts), ..sample }
            }
        };
        Some(changed.into())
    }
}

struct Changed {
    link: Box<dyn Link>,
    line: Line,
    decoder: Decoder,
}

impl Link for Changed {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(&mut *self.link)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let mut received = vec![0; buffer.len()];
            let count = self.link.receive(&mut received, deadline)?;
            let mut bytes = &received[..count];
            let mut passed = Vec::new();
            while let Some(message) = self.decoder.next::<DriveMessage>(&mut bytes) {
                let Numbered { number, message } = message.expect("a drive in process sends good frames");
                passed.extend(self.line.pass(message).map(|it| it.numbered_frame(number).to_vec()));
            }
            let passed = passed.concat();
            buffer[..passed.len()].copy_from_slice(&passed);
            // All of it may be lost; zero bytes would be a timeout.
            if count == 0 || !passed.is_empty() {
                return Ok(passed.len());
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.link.discard_input()
    }
}
