//! What keeps a campaign from being submitted.

use std::io;
use std::path::PathBuf;

use crate::CampaignError;
use lashloop_bench::atomic_file::WriteError;

#[derive(Debug, thiserror::Error)]
pub enum ClusterError {
    #[error("{command} can't be started: {source}; submit where Slurm's commands are in PATH")]
    Start { command: &'static str, source: io::Error },
    #[error("{command} failed: {}; correct the options or the cluster, and submit again", stderr.trim())]
    Failed { command: &'static str, stderr: String },
    #[error("{command} printed {output:?} instead of {expected}")]
    Output { command: &'static str, output: String, expected: &'static str },
    #[error("--shards {shards} is more than the {cases} cases of the campaign: at most one shard per case")]
    Shards { shards: u32, cases: u64 },
    #[error(
        "{text:?} can't be written into a job script: it has a control character or, for sbatch, a backslash, or isn't UTF-8; rename it or choose another \
         folder"
    )]
    Unwritable { text: String },
    #[error(
        "{}: holds another {what}: {there}, here it is {here}; make them the same, or choose another folder with \
         --out",
        folder.display()
    )]
    Other { folder: PathBuf, what: &'static str, there: String, here: String },
    #[error("{}: {problem}; choose another folder with --out", path.display())]
    Malformed { path: PathBuf, problem: String },
    #[error("{} is being used by another `campaign submit`: wait for its end", path.display())]
    InUse { path: PathBuf },
    #[error("{}: can't be {action}: {source}", path.display())]
    Io { path: PathBuf, action: &'static str, source: io::Error },
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Campaign(#[from] CampaignError),
}
