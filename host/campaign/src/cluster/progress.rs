//! How far each shard of a campaign is, from its files alone: it can be read where no scheduler is.

use std::fmt;
use std::io::{self, ErrorKind, Read as _};
use std::path::Path;
use std::time::{Duration, SystemTime};

use crate::shard::Shard;
use crate::shard_file::{complete_path, growing_path};
use lashloop_bench::regular_file::RegularFile;
use serde::Serialize;

use super::error::ClusterError;

/// State of a shard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "state")]
pub enum State {
    NotStarted,
    /// Rows are being added.
    Growing {
        rows: u64,
        last_row_age_s: u64,
    },
    /// The last row is older than a limit: the task has probably ended.
    Stale {
        rows: u64,
        last_row_age_s: u64,
    },
    Complete,
}

/// A shard with its number of cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct ShardProgress {
    /// From 1.
    pub shard: u32,
    pub cases: u64,
    #[serde(flatten)]
    pub state: State,
}

/// All shards of a campaign.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Progress {
    pub cases: u64,
    pub shards: Vec<ShardProgress>,
}

impl Progress {
    /// Reads the files of the shards. A table without a row for `stale_after` before `now` is stale.
    ///
    /// # Errors
    /// A table can't be read.
    pub fn read(
        folder: &Path,
        shards: u32,
        cases: u64,
        stale_after: Duration,
        now: SystemTime,
    ) -> Result<Self, ClusterError> {
        let shards = (1..=shards).filter_map(|number| Shard::new(number, shards));
        let shards = shards.map(|shard| {
            let state = state_of(folder, shard, stale_after, now)?;
            Ok(ShardProgress { shard: shard.number, cases: shard.len(cases), state })
        });
        Ok(Self { cases, shards: shards.collect::<Result<_, ClusterError>>()? })
    }

    /// Numbers of the shards that are not complete.
    #[must_use]
    pub fn unfinished(&self) -> Vec<u32> {
        self.shards.iter().filter(|shard| shard.state != State::Complete).map(|shard| shard.shard).collect()
    }
}

impl ShardProgress {
    #[must_use]
    pub const fn rows(&self) -> u64 {
        match self.state {
            State::NotStarted => 0,
            State::Growing { rows, .. } | State::Stale { rows, .. } => rows,
            State::Complete => self.cases,
        }
    }
}

fn state_of(
    folder: &Path,
    shard: Shard,
    stale_after: Duration,
    now: SystemTime,
) -> Result<State, ClusterError> {
    let path = growing_path(folder, shard);
    let growing = rows(&path);
    // Last, because a table that is renamed between the two looks is complete.
    if complete_path(folder, shard).exists() {
        return Ok(State::Complete);
    }
    match growing {
        Ok((rows, changed)) => {
            // The clock of a file server may be ahead.
            let age = now.duration_since(changed).unwrap_or_default();
            let last_row_age_s = age.as_secs();
            Ok(if age > stale_after {
                State::Stale { rows, last_row_age_s }
            } else {
                State::Growing { rows, last_row_age_s }
            })
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(State::NotStarted),
        Err(source) => Err(ClusterError::Io { path, action: "read", source }),
    }
}

/// Whole lines below the header, and the time of the last write.
fn rows(path: &Path) -> io::Result<(u64, SystemTime)> {
    let mut file = RegularFile::open(path)?.file;
    let changed = file.metadata()?.modified()?;
    let (mut buffer, mut lines) = (vec![0; 1 << 16], 0_u64);
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok((lines.saturating_sub(1), changed)),
            count => lines += buffer[..count].iter().filter(|byte| **byte == b'\n').count() as u64,
        }
    }
}

/// A line for each shard that is not complete, and the sum.
impl fmt::Display for Progress {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.shards.len();
        let mut counts = [0_usize; 4];
        for shard in &self.shards {
            let (kind, text) = match shard.state {
                State::Complete => (0, None),
                State::Growing { last_row_age_s, .. } => {
                    (1, Some(format!("last row {last_row_age_s} s ago")))
                }
                State::Stale { last_row_age_s, .. } => {
                    (2, Some(format!("stale: no row for {last_row_age_s} s")))
                }
                State::NotStarted => (3, Some("not started".to_owned())),
            };
            counts[kind] += 1;
            if let Some(text) = text {
                let name = format!("{}/{count}", shard.shard);
                writeln!(out, "shard {name:<12} {:>9} of {} rows, {text}", shard.rows(), shard.cases)?;
            }
        }
        let [complete, growing, stale, not_started] = counts;
        let rows: u64 = self.shards.iter().map(ShardProgress::rows).sum();
        write!(
            out,
            "{rows} of {} rows; of {count} shards {complete} complete, {growing} growing, {stale} stale, {not_started} not \
             started",
            self.cases
        )
    }
}
