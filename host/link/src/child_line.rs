//! The line to a drive that the bench started: two pipes at its standard input and output, or the controlling end of a
//! pseudo-terminal that it opens by its path.

use std::io::{self, PipeReader, PipeWriter};
use std::os::fd::OwnedFd;
use std::time::{Duration, Instant};

use rustix::io::Errno;

use super::deadline::{readable_by, remaining, send_all};
use super::spin::{Spin, is_readable};
use super::terminal::Terminal;
use super::{Link, LinkError};

/// A nearer deadline is that of a period, which the wait keeps to the nanosecond.
const FAR: Duration = Duration::from_millis(100);

/// The line to a drive that the bench started. Dropping it ends the drive's input.
pub struct ChildLine {
    to_drive: OwnedFd,
    from_drive: OwnedFd,
    /// Keeps the line up until the drive has opened its end. From its first byte on, a closed end is the end of the line.
    until_first_byte: Option<Terminal>,
    /// Whether nothing was sent yet: what the drive prints at its start isn't the input of an earlier host, and explains a drive
    /// that never answers.
    is_fresh: bool,
    spin: Spin,
}

impl ChildLine {
    /// The pipes to the standard input and from the standard output of a process.
    ///
    /// # Errors
    /// The system refused to make them non-blocking.
    pub fn pipes(to_drive: PipeWriter, from_drive: PipeReader) -> io::Result<Self> {
        Self::new(to_drive.into(), from_drive.into(), None)
    }

    /// The end of `terminal` that faces the bench. The drive opens the other end by its path.
    ///
    /// # Errors
    /// The system refused to duplicate it or to make it non-blocking.
    pub fn terminal(terminal: Terminal) -> io::Result<Self> {
        let [to_drive, from_drive] = [terminal.far_end.try_clone()?, terminal.far_end.try_clone()?];
        Self::new(to_drive, from_drive, Some(terminal))
    }

    fn new(to_drive: OwnedFd, from_drive: OwnedFd, until_first_byte: Option<Terminal>) -> io::Result<Self> {
        // The drive's ends are open files of their own and stay blocking.
        for line in [&to_drive, &from_drive] {
            rustix::io::ioctl_fionbio(line, true)?;
        }
        Ok(Self { to_drive, from_drive, until_first_byte, is_fresh: true, spin: Spin::default() })
    }
}

impl Link for ChildLine {
    fn inner(&mut self) -> Option<&mut dyn Link> {
        None
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.is_fresh = false;
        send_all(&self.to_drive, bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> Result<usize, LinkError> {
        loop {
            let is_far = remaining(deadline).is_some_and(|left| left > FAR);
            let is_ready =
                is_far && self.spin.first(|| is_readable(&self.from_drive).then_some(())).is_some();
            if !is_ready && !readable_by(&self.from_drive, deadline)? {
                return Ok(0);
            }
            match rustix::io::read(&self.from_drive, &mut *buffer) {
                Ok(0) => return Err(LinkError::Disconnected),
                Ok(count) => {
                    self.until_first_byte = None;
                    return Ok(count);
                }
                Err(Errno::AGAIN | Errno::INTR) => {
                    if remaining(deadline).is_none() {
                        return Ok(0);
                    }
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn discard_input(&mut self) -> Result<(), LinkError> {
        if self.is_fresh {
            return Ok(());
        }
        // As much as a pipe holds at most. A drive that fills it continues to send, and the rest is no older.
        let mut rest = vec![0; 1 << 16];
        match rustix::io::read(&self.from_drive, &mut rest[..]) {
            Ok(0) => Err(LinkError::Disconnected),
            Ok(_) | Err(Errno::AGAIN | Errno::INTR) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::{Read, Write, pipe};
    use std::time::Duration;

    use super::*;
    use crate::terminal::open_near_end;

    fn soon() -> Instant {
        Instant::now() + Duration::from_secs(10)
    }

    #[test]
    fn bytes_pass_both_ways_over_pipes_until_the_drive_closes_them() {
        let ((mut drive_in, to_drive), (from_drive, mut drive_out)) = (pipe().unwrap(), pipe().unwrap());
        let mut line = ChildLine::pipes(to_drive, from_drive).unwrap();
        line.send(&[1, 0, 255]).unwrap();
        let mut arrived = [9; 3];
        drive_in.read_exact(&mut arrived).unwrap();
        assert_eq!(arrived, [1, 0, 255]);
        drive_out.write_all(&[7, 0]).unwrap();
        let mut buffer = [0; 8];
        assert_eq!((line.receive(&mut buffer, soon()).unwrap(), buffer[..2] == [7, 0]), (2, true));
        assert_eq!(line.receive(&mut buffer, Instant::now() + Duration::from_millis(5)).unwrap(), 0);
        drive_out.write_all(&[3]).unwrap();
        line.discard_input().unwrap();
        assert_eq!(line.receive(&mut buffer, Instant::now()).unwrap(), 0, "the stale byte is discarded");
        drop((drive_in, drive_out));
        assert!(matches!(line.receive(&mut buffer, soon()), Err(LinkError::Disconnected)));
        assert!(matches!(line.send(&[1]), Err(LinkError::Disconnected)));
    }

    #[test]
    fn what_a_drive_prints_at_its_start_is_kept() {
        let ((_drive_in, to_drive), (from_drive, mut drive_out)) = (pipe().unwrap(), pipe().unwrap());
        let mut line = ChildLine::pipes(to_drive, from_drive).unwrap();
        drive_out.write_all(b"usage").unwrap();
        line.discard_input().unwrap();
        let mut buffer = [0; 8];
        assert_eq!(line.receive(&mut buffer, soon()).unwrap(), 5);
    }

    #[test]
    fn a_pipe_without_a_reader_is_stuck_after_the_limit() {
        let ((_drive_in, to_drive), (from_drive, _drive_out)) = (pipe().unwrap(), pipe().unwrap());
        let mut line = ChildLine::pipes(to_drive, from_drive).unwrap();
        assert!(matches!(line.send(&[0; 1 << 20]), Err(LinkError::Stuck)));
    }

    #[test]
    fn a_terminal_stays_up_until_the_drive_has_sent_and_closed_it() {
        let terminal = Terminal::open().unwrap();
        let path = terminal.path.clone();
        let mut line = ChildLine::terminal(terminal).unwrap();
        let mut buffer = [0; 8];
        drop(open_near_end(&path).unwrap());
        let silent = line.receive(&mut buffer, Instant::now() + Duration::from_millis(5));
        assert_eq!(silent.unwrap(), 0, "a program may open and close the terminal to configure it");
        let mut drive = File::from(open_near_end(&path).unwrap());
        drive.write_all(&[13, 10, 0, 3]).unwrap();
        assert_eq!(line.receive(&mut buffer, soon()).unwrap(), 4);
        assert_eq!(buffer[..4], [13, 10, 0, 3], "raw");
        line.send(&[4, 0]).unwrap();
        let mut arrived = [9; 2];
        drive.read_exact(&mut arrived).unwrap();
        assert_eq!(arrived, [4, 0]);
        drop(drive);
        assert!(matches!(line.receive(&mut buffer, soon()), Err(LinkError::Disconnected)));
    }
}
