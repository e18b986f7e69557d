//! Memory and descriptors of a process, as `/proc` shows them.

use std::fs;
use std::io;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Usage {
    /// Resident memory (`VmRSS`).
    pub rss_kib: u64,
    pub descriptors: u64,
}

/// Reads the usage of a process; `None` is this one.
///
/// # Errors
/// The process has ended, or belongs to another user.
pub fn read(process: Option<u32>) -> io::Result<Usage> {
    let folder = process.map_or_else(|| "/proc/self".to_owned(), |id| format!("/proc/{id}"));
    let status = fs::read_to_string(format!("{folder}/status"))?;
    let rss = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let rss_kib = rss.and_then(|rss| rss.trim().strip_suffix("kB")).and_then(|rss| rss.trim().parse().ok());
    Ok(Usage {
        rss_kib: rss_kib.ok_or_else(|| io::Error::other(format!("{folder}/status has no VmRSS")))?,
        descriptors: fs::read_dir(format!("{folder}/fd"))?.count() as u64,
    })
}

/// Growth limit of the bench, after its first cycle through the levels.
pub const BENCH: Usage = Usage { rss_kib: 8 * 1024, descriptors: 4 };
/// Growth limit of a drive's process, within a run. An emulator caches translated code.
pub const DRIVE: Usage = Usage { rss_kib: 8 * 1024, descriptors: 2 };

/// The growth of a process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Growth {
    pub first: Option<Usage>,
    /// Maximum since then.
    pub most: Usage,
}

impl Growth {
    /// Adds a reading.
    pub fn push(&mut self, held: Usage) {
        self.first.get_or_insert(held);
        self.most = Usage {
            rss_kib: self.most.rss_kib.max(held.rss_kib),
            descriptors: self.most.descriptors.max(held.descriptors),
        };
    }

    /// Maximum minus the first reading.
    #[must_use]
    pub fn so_far(&self) -> Usage {
        let first = self.first.unwrap_or(self.most);
        Usage {
            rss_kib: self.most.rss_kib.saturating_sub(first.rss_kib),
            descriptors: self.most.descriptors.saturating_sub(first.descriptors),
        }
    }

    /// The first quantity whose growth exceeds the limit, as a sentence.
    #[must_use]
    pub fn beyond(&self, limit: Usage) -> Option<String> {
        let grown = self.so_far();
        if grown.rss_kib > limit.rss_kib {
            return Some(format!("memory grew by {} KiB, more than {} KiB", grown.rss_kib, limit.rss_kib));
        }
        let (more, allowed) = (grown.descriptors, limit.descriptors);
        (more > allowed).then(|| format!("{more} descriptors more are open, more than {allowed}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: Usage = Usage { rss_kib: 100, descriptors: 2 };

    fn grown(held: &[(u64, u64)]) -> Option<String> {
        let mut growth = Growth::default();
        held.iter().for_each(|&(rss_kib, descriptors)| growth.push(Usage { rss_kib, descriptors }));
        growth.beyond(LIMIT)
    }

    #[test]
    fn a_process_may_grow_to_its_limit_and_no_further() {
        assert_eq!(grown(&[(1000, 10), (1100, 12), (900, 8)]), None);
        assert!(grown(&[(1000, 10), (1101, 10)]).is_some_and(|why| why.contains("memory grew by 101 KiB")));
        assert!(grown(&[(1000, 10), (1000, 13)]).is_some_and(|why| why.contains("3 descriptors more")));
    }

    #[test]
    fn released_growth_counts() {
        assert!(grown(&[(1000, 10), (2000, 10), (1000, 10)]).is_some());
    }

    #[test]
    fn growth_of_this_process_is_measured() {
        let before = read(None).expect("this process");
        let files: Vec<_> = (0..400).map(|_| fs::File::open("/proc/self/status").expect("a file")).collect();
        // black_box keeps the allocation from being optimised away.
        let block = std::hint::black_box(vec![1_u8; 256 << 20]);
        let after = read(None).expect("this process");
        // Half of it, because tests in other threads release memory and descriptors meanwhile.
        assert!(after.descriptors >= before.descriptors + 200, "{before:?}, {after:?}");
        assert!(after.rss_kib > before.rss_kib + 128 * 1024, "{before:?}, {after:?}");
        assert_eq!((files.len(), block[7]), (400, 1));
    }

    #[test]
    fn missing_process_is_an_error() {
        assert!(read(Some(u32::MAX)).is_err());
    }
}
