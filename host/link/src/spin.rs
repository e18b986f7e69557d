//! Reads that don't wait, before one that does: the kernel takes longer to wake a thread, often on another core, than a drive
//! in another process takes to answer.

use std::num::NonZeroUsize;
use std::os::fd::AsFd;
use std::thread;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

/// Reads before a wait: some tens of microseconds.
const READS: u32 = 200;
/// Waits at most before the next attempt.
const MOST_SKIPPED: u32 = 1024;

/// Whether `line` is readable now. The end of a line is readable.
pub fn is_readable(line: impl AsFd) -> bool {
    let mut fds = [PollFd::new(&line, PollFlags::IN)];
    poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 })).is_ok_and(|count| count > 0)
}

/// How often it pays. Where the answer takes longer, or the drive has no core of its own, attempts become rare.
pub struct Spin {
    is_useful: bool,
    /// Waits before the next attempt.
    skip: u32,
    /// The same after the next failure.
    next_skip: u32,
}

impl Default for Spin {
    /// For this machine: a single core is the drive's.
    fn default() -> Self {
        Self::on(thread::available_parallelism().map_or(1, NonZeroUsize::get))
    }
}

impl Spin {
    fn on(cores: usize) -> Self {
        Self { is_useful: cores > 1, skip: 0, next_skip: 1 }
    }

    /// Calls `read` until it returns something, a few times at most; `None` if the caller has to wait.
    pub fn first<T>(&mut self, read: impl FnMut() -> Option<T>) -> Option<T> {
        if !self.is_useful {
            return None;
        }
        if self.skip > 0 {
            self.skip -= 1;
            return None;
        }
        let found = std::iter::repeat_with(read).take(READS as usize).flatten().next();
        match found {
            Some(_) => self.next_skip = 1,
            None => {
                self.skip = self.next_skip;
                self.next_skip = (2 * self.next_skip).min(MOST_SKIPPED);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads in each of `waits` waits for an answer that `after` reads bring.
    fn reads(spin: &mut Spin, waits: u32, after: u32) -> Vec<u32> {
        let one = |_| {
            let mut count = 0;
            let _ = spin.first(|| {
                count += 1;
                (count > after).then_some(())
            });
            count
        };
        (0..waits).map(one).collect()
    }

    #[test]
    fn attempts_become_rare_while_they_fail_and_resume_with_the_first_success() {
        let mut spin = Spin::on(2);
        assert_eq!(reads(&mut spin, 2, 20), [21, 21]);
        assert_eq!(reads(&mut spin, 8, READS), [READS, 0, READS, 0, 0, READS, 0, 0]);
        let failed = reads(&mut spin, 100_000, READS).iter().filter(|it| **it > 0).count();
        assert!(failed < 110, "{failed}");
        assert_eq!(
            reads(&mut spin, MOST_SKIPPED + 1, 20).last(),
            Some(&21),
            "the next attempt is not far off"
        );
        assert_eq!(reads(&mut spin, 2, 20), [21, 21]);
    }

    #[test]
    fn a_single_core_is_left_to_the_drive() {
        assert_eq!(reads(&mut Spin::on(1), 3, 0), [0, 0, 0]);
    }
}
