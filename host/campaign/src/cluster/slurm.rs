//! Slurm's commands: `sbatch`, `squeue`, `scancel`. They, unlike its libraries, are the same on every cluster.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::error::ClusterError;

const SBATCH: &str = "sbatch";
const SQUEUE: &str = "squeue";
const SCANCEL: &str = "scancel";

/// A job that waits or runs, or a task of an array job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Queued {
    pub job: u32,
    /// Index in the array.
    pub index: Option<u32>,
    pub is_pending: bool,
    /// Path of its script.
    pub script: PathBuf,
}

/// Submits a script and returns the number of the job.
///
/// # Errors
/// `sbatch` is missing or rejects the job.
pub fn submit(script: &Path, options: &[String]) -> Result<u32, ClusterError> {
    let text = output(SBATCH, Command::new(SBATCH).arg("--parsable").args(options).arg(script))?;
    // `JOB`, or `JOB;CLUSTER` with several clusters.
    let job = text.trim().split(';').next().and_then(|job| job.parse().ok());
    job.ok_or(ClusterError::Output { command: SBATCH, output: text, expected: "the number of a job" })
}

/// The user's jobs that wait or run. A task whose processes have ended is none of them.
///
/// # Errors
/// `squeue` is missing, or the controller doesn't answer.
pub fn queue() -> Result<Vec<Queued>, ClusterError> {
    let text =
        output(SQUEUE, Command::new(SQUEUE).args(["--me", "--noheader", "--array", "--format=%F %K %T %o"]))?;
    let lines = text.lines().filter(|line| line.split(' ').nth(2) != Some("COMPLETING"));
    let queued = lines.map(|line| {
        queued(line).ok_or_else(|| ClusterError::Output {
            command: SQUEUE,
            output: line.to_owned(),
            expected: "job, index, state and script",
        })
    });
    queued.collect()
}

/// Removes a job that waits.
///
/// # Errors
/// `scancel` is missing or rejects the job.
pub fn cancel_pending(job: u32) -> Result<(), ClusterError> {
    output(SCANCEL, Command::new(SCANCEL).args(["--state=PENDING", &job.to_string()])).map(drop)
}

fn queued(line: &str) -> Option<Queued> {
    let mut fields = line.splitn(4, ' ');
    let mut next = || fields.next();
    // Of a job that isn't an array, the index is `N/A`.
    let (job, index, is_pending) = (next()?.parse().ok()?, next()?.parse().ok(), next()? == "PENDING");
    Some(Queued { job, index, is_pending, script: next()?.into() })
}

fn output(name: &'static str, command: &mut Command) -> Result<String, ClusterError> {
    let output = command.stdin(Stdio::null()).output();
    let output = output.map_err(|source| ClusterError::Start { command: name, source })?;
    if !output.status.success() {
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(ClusterError::Failed { command: name, stderr });
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Numbers in ascending order as Slurm writes an array: `1-3,7`.
#[must_use]
pub fn ranges(numbers: &[u32]) -> String {
    let runs = numbers.chunk_by(|one, next| one + 1 == *next);
    let text = runs.filter_map(|run| match run {
        [] => None,
        [one] => Some(one.to_string()),
        [first, .., last] => Some(format!("{first}-{last}")),
    });
    text.collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::{Queued, queued, ranges};

    #[test]
    fn an_array_is_written_in_ranges() {
        for (numbers, text) in
            [(&[1, 2, 3, 4][..], "1-4"), (&[2, 5, 6, 9], "2,5-6,9"), (&[7], "7"), (&[], "")]
        {
            assert_eq!(ranges(numbers), text);
        }
    }

    #[test]
    fn a_line_of_the_queue_is_a_task_or_a_job() {
        let job =
            |job, index, is_pending, script: &str| Queued { job, index, is_pending, script: script.into() };
        assert_eq!(queued("12 3 RUNNING /a b/s.sh"), Some(job(12, Some(3), false, "/a b/s.sh")));
        assert_eq!(queued("13 N/A PENDING (null)"), Some(job(13, None, true, "(null)")));
        assert_eq!(queued("slurm_load_jobs error"), None);
    }
}
