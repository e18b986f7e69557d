//! A shard: its cases run in parallel, and their rows written in the order of cases.

use std::num::NonZeroUsize;
use std::path::Path;

use lashloop_bench::supervisor::Supervisor;

use crate::campaign::Campaign;
use crate::error::CampaignError;
use crate::facts::Facts;
use crate::plan::Case;
use crate::row::{CaseResult, Columns};
use crate::shard::Shard;
use crate::shard_file::{self, Opened, Start};
use crate::workers::{self, Ended, Order, Stop};

/// A shard to run.
#[derive(Debug)]
pub struct ShardRun<'a> {
    pub campaign: &'a Campaign,
    pub facts: &'a Facts,
    pub folder: &'a Path,
    pub shard: Shard,
    pub start: Start,
    pub jobs: NonZeroUsize,
}

/// How far a shard came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    pub ended: Ended,
    /// Rows of earlier commands.
    pub restored: u64,
    /// Rows in all.
    pub rows: u64,
}

impl ShardRun<'_> {
    /// Runs the cases without a row. `run_one` returns `None` if it was stopped; `seen` gets the number of rows after each.
    ///
    /// # Errors
    /// The table belongs to another campaign or can't be written, or a run fails. Rows before the error are kept.
    pub fn run(
        &self,
        supervisor: &Supervisor,
        run_one: impl Fn(u64, &Stop<'_>) -> Result<Option<(Case, CaseResult)>, CampaignError> + Sync,
        mut seen: impl FnMut(u64),
    ) -> Result<Progress, CampaignError> {
        let Self { campaign, facts, folder, shard, start, jobs } = *self;
        let columns = Columns::of(campaign);
        let all = shard.len(campaign.plan.cases());
        let opened = shard_file::open(folder, shard, facts, &columns.header(), start)?;
        let (mut table, restored) = match opened {
            Opened::Complete => return Ok(Progress { ended: Ended::Complete, restored: all, rows: all }),
            Opened::Growing(table, rows) => (table, rows.min(all)),
        };
        let mut rows = restored;
        seen(rows);
        let mut line = Vec::new();
        let ended = workers::run_all(
            all - restored,
            jobs,
            Order::Cases,
            supervisor,
            |row, stop| run_one(shard.case(restored + row), stop),
            |(case, result)| {
                line.clear();
                columns.write(campaign, &case, &result, &mut line);
                table.append(&line)?;
                rows += 1;
                seen(rows);
                Ok(())
            },
        )?;
        if ended == Ended::Complete {
            table.finish()?;
        }
        Ok(Progress { ended, restored, rows })
    }
}
