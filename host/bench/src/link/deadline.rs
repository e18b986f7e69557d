//! Waiting for a file descriptor until a deadline, in wall-clock time.

use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use super::LinkError;

/// Time until the deadline; `None` once it has passed.
pub(super) fn remaining(deadline: Instant) -> Option<Duration> {
    deadline.checked_duration_since(Instant::now()).filter(|left| !left.is_zero())
}

/// Whether `line` is readable by the deadline. The end of a line is readable.
pub(super) fn readable_by(line: impl AsFd, deadline: Instant) -> Result<bool, LinkError> {
    loop {
        let mut fds = [PollFd::new(&line, PollFlags::IN)];
        let left = remaining(deadline).unwrap_or_default();
        let left = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: left.subsec_nanos().into() };
        match poll(&mut fds, Some(&left)) {
            Ok(count) => return Ok(count > 0),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error.into()),
        }
    }
}
