//! Submits the jobs of a plan, and records each as soon as Slurm has it.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::Path;

use lashloop_bench::atomic_file::write_whole;

use super::error::ClusterError;
use super::scripts::{MERGE, SHARDS, Scripts};
use super::slurm;
use super::submission::{Jobs, Submission};

/// Submits the tasks of these shards and returns their array job.
///
/// # Errors
/// The script can't be written, or `sbatch` rejects it.
pub fn submit_shards(
    submission: &mut Submission,
    scripts: &Scripts<'_>,
    shards: &[u32],
) -> Result<u32, ClusterError> {
    let script = scripts.logs.join(SHARDS);
    write_script(&script, &scripts.of_shards(shards)?)?;
    let array = slurm::submit(&script, &[])?;
    // Before the merge, which may be rejected: these tasks must not be submitted again.
    submission.jobs.push(Jobs { array: Some(array), merge: None });
    submission.write(scripts.out)?;
    Ok(array)
}

/// Submits the merge, after these array jobs, and returns its job.
///
/// # Errors
/// The script can't be written, or `sbatch` rejects it.
pub fn submit_merge(
    submission: &mut Submission,
    scripts: &Scripts<'_>,
    arrays: &BTreeSet<u32>,
) -> Result<u32, ClusterError> {
    let script = scripts.logs.join(MERGE);
    write_script(&script, &scripts.of_merge()?)?;
    // Not afterok, with which the merge of a dead task waits forever: the merge finds out which shard is missing, and fails.
    let after: String = arrays.iter().map(|array| format!(":{array}")).collect();
    let dependency = (!after.is_empty()).then(|| format!("--dependency=afterany{after}"));
    let merge = slurm::submit(&script, dependency.as_slice())?;
    match submission.jobs.last_mut() {
        Some(jobs @ Jobs { merge: None, .. }) => jobs.merge = Some(merge),
        _ => submission.jobs.push(Jobs { array: None, merge: Some(merge) }),
    }
    submission.write(scripts.out)?;
    Ok(merge)
}

fn write_script(path: &Path, text: &str) -> Result<(), ClusterError> {
    Ok(write_whole(path, ".script-", |file| file.write_all(text.as_bytes()))?)
}
