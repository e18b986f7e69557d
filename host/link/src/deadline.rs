//! Waits on file descriptors with a deadline, in wall-clock time.

use std::os::fd::AsFd;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

use super::LinkError;
use super::error::{WHOLE_WRITE_LIMIT, WRITE_LIMIT};

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

/// Writes all of `bytes` to a non-blocking `line`. A line that takes no byte for [`WRITE_LIMIT`], or not all of them for
/// [`WHOLE_WRITE_LIMIT`], is stuck.
pub(super) fn send_all(line: impl AsFd, mut bytes: &[u8]) -> Result<(), LinkError> {
    let mut give_up = None;
    while !bytes.is_empty() {
        match rustix::io::write(&line, bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(Errno::INTR) => {}
            Err(Errno::AGAIN) => {
                let give_up = *give_up.get_or_insert_with(|| Instant::now() + WHOLE_WRITE_LIMIT);
                let mut fds = [PollFd::new(&line, PollFlags::OUT)];
                let limit = Timespec { tv_sec: WRITE_LIMIT.as_secs() as i64, tv_nsec: 0 };
                if poll(&mut fds, Some(&limit))? == 0 || remaining(give_up).is_none() {
                    return Err(LinkError::Stuck);
                }
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}
