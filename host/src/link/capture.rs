//! A link whose every frame goes into a capture on its way. Without a capture there is no such link, and no cost.

use std::time::Instant;

use lashloop_protocol::layout::Direction;

use super::{Link, LinkError};
use crate::capture::{Capture, Splitter};

/// A link with an ear on it.
pub struct Captured {
    link: Box<dyn Link>,
    capture: Capture,
    sent: Splitter,
    received: Splitter,
}

impl Captured {
    /// Listens on `link`.
    #[must_use]
    pub fn new(link: Box<dyn Link>, capture: Capture) -> Self {
        Self { link, capture, sent: Splitter::default(), received: Splitter::default() }
    }

    /// Half a frame that nothing will complete is a packet as well.
    fn end_pieces(&mut self) {
        let Self { capture, sent, received, .. } = self;
        received.finish(|piece| capture.push(Direction::DriveToHost, piece));
        sent.finish(|piece| capture.push(Direction::HostToDrive, piece));
    }
}

impl Link for Captured {
    /// What can't be sent is captured too: it is what the failure was about.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let Self { link, capture, sent, .. } = self;
        sent.push(bytes, |piece| capture.push(Direction::HostToDrive, piece));
        link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let Self { link, capture, received, .. } = self;
        // The drive is at work and we would only wait.
        capture.flush();
        let count = link.receive(buffer, deadline)?;
        received.push(&buffer[..count], |piece| capture.push(Direction::DriveToHost, piece));
        Ok(count)
    }

    /// What is thrown away here has never been read, so it is not in the capture.
    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.end_pieces();
        self.link.discard_input()
    }
}

impl Drop for Captured {
    fn drop(&mut self) {
        self.end_pieces();
        self.capture.flush();
    }
}
