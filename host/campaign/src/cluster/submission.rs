//! What was submitted into a folder, `slurm/submission.json`, and what a further command submits.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;

use crate::facts::Facts;
use crate::shard_file::{complete_path, facts_path, shards_in};
use crate::{Campaign, Selection, Source};
use lashloop_bench::{regular_file, resume};
use lashloop_record::json_file::write_json;
use serde::{Deserialize, Serialize};

use super::error::ClusterError;
use super::scripts::{MERGE, SHARDS};
use super::slurm::Queued;

/// Folder of the scripts, the logs and the submission, in the folder of the results.
pub const FOLDER: &str = "slurm";
const FILE: &str = "submission.json";

/// What all jobs of a folder have in common.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Subject {
    pub lashloop: String,
    pub program_sha256: String,
    pub campaign_sha256: String,
    pub scenarios_sha256: Vec<String>,
    pub selection: Selection,
    pub device: String,
    pub cases: u64,
    pub shards: u32,
}

/// Jobs of one command.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Jobs {
    /// The array job, unless only the merge was submitted.
    pub array: Option<u32>,
    /// `None` until it is submitted after the array job.
    pub merge: Option<u32>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Submission {
    pub subject: Subject,
    /// In the order of submission.
    pub jobs: Vec<Jobs>,
}

/// Jobs of a submission that wait or run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Active {
    pub arrays: BTreeSet<u32>,
    pub shards: BTreeSet<u32>,
    /// Merges, and whether they wait.
    pub merges: Vec<(u32, bool)>,
}

/// What a command submits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plan {
    pub shards: Vec<u32>,
    pub merge: bool,
}

impl Subject {
    #[must_use]
    pub fn new(campaign: &Campaign, program_sha256: String, device: String, shards: u32) -> Self {
        let mut hashes = campaign.sources.iter().map(Source::sha256);
        Self {
            lashloop: env!("CARGO_PKG_VERSION").to_owned(),
            program_sha256,
            campaign_sha256: hashes.next().unwrap_or_default(),
            scenarios_sha256: hashes.collect(),
            selection: campaign.selection.clone(),
            device,
            cases: campaign.plan.cases(),
            shards,
        }
    }

    fn facts(&self) -> [(&'static str, String); 7] {
        let Self {
            lashloop,
            program_sha256,
            campaign_sha256,
            scenarios_sha256,
            selection,
            device,
            cases,
            shards,
        } = self;
        [
            ("number of shards", shards.to_string()),
            ("campaign file (SHA-256)", campaign_sha256.clone()),
            ("scenario (SHA-256)", scenarios_sha256.join(" ")),
            ("selection of cases", format!("{cases} cases, {}", serde_json::json!(selection))),
            ("device", device.clone()),
            ("version of lashloop", lashloop.clone()),
            ("build of lashloop (SHA-256)", program_sha256.clone()),
        ]
    }
}

impl Submission {
    /// The submission of a folder; `None` if there is none.
    ///
    /// # Errors
    /// The file can't be read, or is of another format.
    pub fn read(out: &Path) -> Result<Option<Self>, ClusterError> {
        let path = out.join(FOLDER).join(FILE);
        let text = match regular_file::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(ClusterError::Io { path, action: "read", source }),
        };
        let parsed = serde_json::from_slice(&text);
        parsed.map(Some).map_err(|error| ClusterError::Malformed { path, problem: error.to_string() })
    }

    /// The submission of a folder, or a new one, for a further command on `subject`.
    ///
    /// # Errors
    /// As [`read`](Self::read), or the folder has another subject.
    pub fn open(out: &Path, subject: Subject) -> Result<Self, ClusterError> {
        let Some(found) = Self::read(out)? else { return Ok(Self { subject, jobs: Vec::new() }) };
        let facts = found.subject.facts().into_iter().zip(subject.facts());
        for ((what, there), (_, here)) in facts {
            if there != here {
                return Err(ClusterError::Other { folder: out.to_owned(), what, there, here });
            }
        }
        Ok(found)
    }

    /// # Errors
    /// The file can't be written.
    pub fn write(&self, out: &Path) -> Result<(), ClusterError> {
        Ok(write_json(&out.join(FOLDER).join(FILE), ".submission-", self)?)
    }

    /// The jobs of this folder among those of the queue: the recorded ones, and all of its scripts. A command that was killed
    /// after `sbatch` recorded none.
    #[must_use]
    pub fn active(&self, out: &Path, queue: &[Queued]) -> Active {
        let mut active = Active::default();
        let [of_shards, of_merge] = [SHARDS, MERGE].map(|name| out.join(FOLDER).join(name));
        for Queued { job, index, is_pending, script } in queue {
            match index {
                Some(shard) if *script == of_shards || self.jobs.iter().any(|it| it.array == Some(*job)) => {
                    active.arrays.insert(*job);
                    active.shards.insert(*shard);
                }
                None if *script == of_merge || self.jobs.iter().any(|it| it.merge == Some(*job)) => {
                    active.merges.push((*job, *is_pending));
                }
                _ => {}
            }
        }
        active
    }
}

/// Checks that the shards in a folder are of this campaign, whoever ran them. `facts` has any drive: a command that submits
/// opens none.
///
/// # Errors
/// A shard is of another campaign, or of another number of shards, or can't be read.
pub fn check_shards(out: &Path, facts: &Facts) -> Result<(), ClusterError> {
    let other = |what, there, here| ClusterError::Other { folder: out.to_owned(), what, there, here };
    for shard in shards_in(out)? {
        if shard.count != facts.shards {
            return Err(other("number of shards", shard.count.to_string(), facts.shards.to_string()));
        }
        let path = facts_path(out, shard);
        if !path.exists() && !complete_path(out, shard).exists() {
            continue;
        }
        let there = Facts::read(&path)?;
        let here = Facts { drive: there.drive.clone(), ..facts.clone() };
        if let Some((what, there, here)) = there.difference(&here) {
            return Err(other(what, there, here));
        }
    }
    Ok(())
}

impl Plan {
    /// Every unfinished shard needs a task, and a merge has to follow the last one.
    #[must_use]
    pub fn new(unfinished: &[u32], active: &Active, is_merged: bool) -> Self {
        let shards: Vec<_> =
            unfinished.iter().copied().filter(|shard| !active.shards.contains(shard)).collect();
        let is_done = unfinished.is_empty() && is_merged;
        let merge = !shards.is_empty() || (active.merges.is_empty() && !is_done);
        Self { shards, merge }
    }
}

/// Excludes a second command on the same folder, until it is dropped.
#[derive(Debug)]
pub struct Lock(#[expect(dead_code, reason = "the open file is the lock")] File);

impl Lock {
    /// # Errors
    /// Another command has it, or the file can't be created.
    pub fn take(out: &Path) -> Result<Self, ClusterError> {
        let path = out.join(FOLDER).join("lock");
        let error = |action| {
            let path = path.clone();
            move |source| ClusterError::Io { path, action, source }
        };
        let file = File::create(&path).map_err(error("created"))?;
        if !resume::lock(&file).map_err(error("locked"))? {
            return Err(ClusterError::InUse { path });
        }
        Ok(Self(file))
    }
}

#[cfg(test)]
mod tests {
    use super::{Active, Plan};

    fn active(shards: &[u32], merges: &[(u32, bool)]) -> Active {
        let shards: std::collections::BTreeSet<_> = shards.iter().copied().collect();
        Active { arrays: shards.first().map(|_| 10).into_iter().collect(), shards, merges: merges.to_vec() }
    }

    #[test]
    fn only_shards_without_a_task_are_submitted() {
        for (unfinished, shards, merges, is_merged, wanted) in [
            // Nothing has been submitted.
            (&[1, 2, 3][..], &[][..], &[][..], false, (&[1, 2, 3][..], true)),
            // All of it runs.
            (&[1, 2, 3], &[1, 2, 3], &[(11, true)], false, (&[], false)),
            // One task has died, the others run: a new merge waits for all of them.
            (&[1, 2, 3], &[1, 3], &[(11, true)], false, (&[2], true)),
            // `sbatch` rejected the merge.
            (&[1, 2], &[1, 2], &[], false, (&[], true)),
            (&[], &[], &[], false, (&[], true)),
            (&[], &[], &[(11, false)], false, (&[], false)),
            (&[], &[], &[], true, (&[], false)),
            // A table of former shards does not count.
            (&[4], &[], &[], true, (&[4], true)),
        ] {
            let plan = Plan::new(unfinished, &active(shards, merges), is_merged);
            assert_eq!((&plan.shards[..], plan.merge), wanted, "{unfinished:?} {shards:?} {merges:?}");
        }
    }
}
