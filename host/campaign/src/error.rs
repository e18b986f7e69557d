//! What ends a campaign early.

use std::io;
use std::path::PathBuf;

use lashloop::execution::ExecutionError;
use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::resume::ResumeError;
use lashloop_bench::scenario::ScenarioErrors;
use lashloop_record::folder::FolderError;

use crate::settings::TORQUE_DIGEST;
use crate::shard::{AutoShardError, Shard};

#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    #[error("{file}: {problem}")]
    Unusable { file: String, problem: String },
    #[error("{place}: {source}")]
    Case { place: String, source: ScenarioErrors },
    #[error("case {case}: {source}")]
    Run { case: u64, source: Box<ExecutionError> },
    #[error("there is no case {case}; the campaign has cases 0 to {last}")]
    NoCase { case: u64, last: u64 },
    #[error("{}: can't be {action}: {source}", path.display())]
    Io { path: PathBuf, action: &'static str, source: io::Error },
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Resume(#[from] ResumeError),
    #[error("{}:{line}: {problem}; choose another folder with --out, or remove the line", path.display())]
    Journal {
        path: PathBuf,
        /// From 1.
        line: usize,
        problem: String,
    },
    #[error("{}: holds no shard of a campaign; name the folder of `campaign run --out`", folder.display())]
    NoShards { folder: PathBuf },
    #[error(
        "{0}: shard {shard} is {state}; complete it with `lashloop campaign run FILE --shard {shard} --out {0} --resume`, with the \
         campaign file and the options of the other shards",
        folder.display()
    )]
    Incomplete { folder: PathBuf, shard: Shard, state: &'static str },
    #[error(
        "shard {shard} can't be merged: its {what} is {there}, that of shard {first} is {here}; remove the files of one of them, \
         and run it again"
    )]
    Mixed { shard: Shard, first: Shard, what: &'static str, there: String, here: String },
    #[error("shard {shard}, line {line}: {problem}; remove {}, and run the shard again", path.display())]
    Malformed { path: PathBuf, shard: Shard, line: u64, problem: String },
    #[error(
        "shard {shard}: the SHA-256 of {0} is {now}, that of the table as it was completed {complete}; remove {0}, and run the shard \
         again",
        path.display()
    )]
    Changed { path: PathBuf, shard: Shard, complete: String, now: String },
    #[error(
        "{}: is missing, so the campaign of its table is unknown; remove the table, and run the shard or the merge again",
        path.display()
    )]
    NoFacts { path: PathBuf },
    #[error(
        "{}: merging {shards} shards takes {wanted} open files, and the limit of this user is {limit}; raise it (`ulimit -Hn`), or \
         run the campaign in fewer shards",
        folder.display()
    )]
    OpenFiles { folder: PathBuf, shards: u32, limit: u64, wanted: u64 },
    #[error("{}:{line}: {problem}; merge the shards again", path.display())]
    Table { path: PathBuf, line: u64, problem: String },
    #[error(
        "case {case}: {} {again:?}, in the table {before:?}; the drive or the program is not the same, or the table was edited",
        if column == TORQUE_DIGEST { "torque digest" } else { column }
    )]
    NotRepeated { case: u64, column: String, before: String, again: String },
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    AutoShard(#[from] AutoShardError),
}

/// For `map_err` of file operations.
pub(crate) fn io_error(
    path: &std::path::Path,
    action: &'static str,
) -> impl FnOnce(io::Error) -> CampaignError {
    move |source| CampaignError::Io { path: path.to_owned(), action, source }
}
