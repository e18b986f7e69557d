//! The middleware that captures a link. A run without a capture has none, and no cost.

use std::time::Instant;

use lashloop_link::{Link, LinkError};
use lashloop_protocol::layout::Direction;

use crate::capture::{Recorder, Splitter};

/// A link and the capture of its bytes.
pub struct Captured {
    link: Box<dyn Link>,
    capture: Recorder,
    sent: Splitter,
    received: Splitter,
}

impl Captured {
    /// Captures `link`.
    #[must_use]
    pub fn new(link: Box<dyn Link>, capture: Recorder) -> Self {
        Self { link, capture, sent: Splitter::default(), received: Splitter::default() }
    }

    /// Records the partial frames of both directions, which no byte completes.
    fn end_pieces(&mut self) {
        let Self { capture, sent, received, .. } = self;
        received.finish(|piece| capture.push(Direction::DriveToHost, piece));
        sent.finish(|piece| capture.push(Direction::HostToDrive, piece));
    }
}

impl Link for Captured {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        Some(self.link.as_mut())
    }

    /// Captures bytes before sending them, because a failed send is worth seeing.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let Self { link, capture, sent, .. } = self;
        sent.push(bytes, |piece| capture.push(Direction::HostToDrive, piece));
        link.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        let Self { link, capture, received, .. } = self;
        let count = link.receive(buffer, deadline)?;
        received.push(&buffer[..count], |piece| capture.push(Direction::DriveToHost, piece));
        Ok(count)
    }

    /// Discarded bytes are never read, so the capture omits them.
    fn discard_input(&mut self) -> Result<(), LinkError> {
        self.end_pieces();
        self.link.discard_input()
    }
}

impl Drop for Captured {
    fn drop(&mut self) {
        self.end_pieces();
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::Duration;

    use super::*;
    use crate::capture::{WhenFull, create, reader};

    /// Delivers its pieces one by one, then disconnects; takes nothing.
    struct Torn(Vec<&'static [u8]>);

    impl Link for Torn {
        fn inner(&mut self) -> Option<&mut dyn Link> {
            None
        }

        fn send(&mut self, _bytes: &[u8]) -> Result<(), LinkError> {
            Err(LinkError::Disconnected)
        }

        fn receive(&mut self, buffer: &mut [u8], _deadline: Instant) -> Result<usize, LinkError> {
            let piece = self.0.pop().ok_or(LinkError::Disconnected)?;
            buffer[..piece.len()].copy_from_slice(piece);
            Ok(piece.len())
        }

        fn discard_input(&mut self) -> Result<(), LinkError> {
            Ok(())
        }
    }

    #[test]
    fn damaged_bytes_and_partial_frames_are_captured_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("line.pcapng");
        let (recorder, capture) = create(&path, WhenFull::Fail).unwrap();
        let pieces: Vec<&[u8]> = vec![&[8, 8], &[9, 0, 0xff], &[3, 7]];
        let mut link = Captured::new(Box::new(Torn(pieces)), recorder);
        assert!(link.send(&[2, 5, 0]).is_err());
        let mut buffer = [0; 64];
        while link.receive(&mut buffer, Instant::now() + Duration::from_secs(1)).is_ok() {}
        drop(link);
        assert_eq!(capture.finish().unwrap(), 3);
        let bytes = fs::read(&path).unwrap();
        let packets: Vec<_> = reader::packets(&bytes).map(Result::unwrap).collect();
        let kept: Vec<_> = packets.iter().map(|packet| (packet.direction, &packet.bytes[..])).collect();
        let (to_drive, to_host) = (Some(Direction::HostToDrive), Some(Direction::DriveToHost));
        let expected: [(_, &[u8]); 3] =
            [(to_drive, &[2, 5, 0]), (to_host, &[3, 7, 9, 0]), (to_host, &[0xff, 8, 8])];
        assert_eq!(kept, expected, "a frame the link refused, a frame in two pieces, half a frame");
        assert!(packets.is_sorted_by_key(|packet| packet.time_ns));
    }

    #[test]
    fn the_request_to_a_silent_drive_is_written_during_the_wait() {
        struct Looking(std::path::PathBuf);
        impl Link for Looking {
            fn inner(&mut self) -> Option<&mut dyn Link> {
                None
            }

            fn send(&mut self, _bytes: &[u8]) -> Result<(), LinkError> {
                Ok(())
            }

            fn receive(&mut self, _buffer: &mut [u8], _deadline: Instant) -> Result<usize, LinkError> {
                let deadline = Instant::now() + Duration::from_secs(10);
                loop {
                    let bytes = fs::read(&self.0)?;
                    let packets: Vec<_> = reader::packets(&bytes).map(Result::unwrap).collect();
                    if let [packet] = &packets[..] {
                        assert_eq!(packet.bytes, [2, 5, 0]);
                        return Ok(0);
                    }
                    assert!(packets.is_empty() && Instant::now() < deadline, "{} packets", packets.len());
                }
            }

            fn discard_input(&mut self) -> Result<(), LinkError> {
                Ok(())
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("line.pcapng");
        let (recorder, _capture) = create(&path, WhenFull::Fail).unwrap();
        let mut link = Captured::new(Box::new(Looking(path)), recorder);
        link.send(&[2, 5, 0]).unwrap();
        assert_eq!(link.receive(&mut [0; 8], Instant::now()).unwrap(), 0);
    }
}
