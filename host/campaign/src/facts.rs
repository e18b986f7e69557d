//! What the shards of a campaign must have in common, and what runs a case again: `shard-K-of-N.json`, `campaign.json`.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use lashloop_bench::atomic_file::WriteError;
use lashloop_bench::regular_file;
use lashloop_bench::run::digest;
use lashloop_plant::Plants;
use lashloop_record::json_file::write_json;
use serde::{Deserialize, Serialize};

use crate::campaign::{Campaign, Selection, Source};
use crate::error::{CampaignError, io_error};

/// The facts of a merged campaign.
pub const CAMPAIGN: &str = "campaign.json";

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    /// Version of the program.
    pub lashloop: String,
    /// SHA-256 of the program's file, which holds the plant, and the drive of a run in process.
    pub program_sha256: String,
    pub device: String,
    /// SHA-256 of the files that ran as the drive; its own description if it has none.
    pub drive: String,
    pub seed: u64,
    pub cases: u64,
    /// Number of shards.
    pub shards: u32,
    pub selection: Selection,
    /// The campaign file, its scenarios, and their tables.
    pub sources: Vec<Source>,
    /// SHA-256 of the complete table of a shard.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_sha256: Option<String>,
}

/// The first fact that differs, in lists of the same facts: its name, and its value in each.
#[must_use]
pub(crate) fn first_difference(
    there: Vec<(&'static str, String)>,
    here: Vec<(&'static str, String)>,
) -> Option<(&'static str, String, String)> {
    let pairs = there.into_iter().zip(here);
    pairs.map(|((what, there), (_, here))| (what, there, here)).find(|(_, there, here)| there != here)
}

/// SHA-256 of this program's file. Plant and drive are part of it, so another build may give other results.
///
/// # Errors
/// The file can't be read.
pub fn program_sha256() -> io::Result<String> {
    std::env::current_exe().and_then(fs::read).map(|bytes| digest::sha256(&bytes))
}

/// What the facts of a campaign can't be taken from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    pub lashloop: String,
    pub sha256: String,
    pub device: String,
    pub drive: String,
}

impl Facts {
    #[must_use]
    pub fn new(campaign: &Campaign, program: Program, shards: u32) -> Self {
        let Program { lashloop, sha256, device, drive } = program;
        Self {
            lashloop,
            program_sha256: sha256,
            device,
            drive,
            seed: campaign.file.seed,
            cases: campaign.plan.cases(),
            shards,
            selection: campaign.selection.clone(),
            sources: campaign.sources.clone(),
            table_sha256: None,
        }
    }

    /// The campaign, with these plant models.
    ///
    /// # Errors
    /// The texts are not those of a campaign, for instance because plant models are missing.
    pub fn campaign(&self, plants: &Plants) -> Result<Campaign, CampaignError> {
        Campaign::from_sources(self.sources.clone(), self.selection.clone(), plants)
    }

    /// # Errors
    /// The file can't be read, or is not of this format.
    pub fn read(path: &Path) -> Result<Self, CampaignError> {
        let text = regular_file::read(path).map_err(|source| match source.kind() {
            ErrorKind::NotFound => CampaignError::NoFacts { path: path.to_owned() },
            _ => io_error(path, "read")(source),
        })?;
        serde_json::from_slice(&text).map_err(|error| CampaignError::Unusable {
            file: path.display().to_string(),
            problem: format!(
                "is of another format: {error}; remove it with its table, and run the shard or the merge again"
            ),
        })
    }

    /// # Errors
    /// The file can't be written.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write_json(path, ".facts-", self)
    }

    /// The first fact that differs: its name, its value in `self`, and that in `other`.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        first_difference(self.list(), other.list())
    }

    /// Names and values, with hashes instead of texts.
    #[must_use]
    pub fn list(&self) -> Vec<(&'static str, String)> {
        let Self { lashloop, program_sha256, device, drive, seed, cases, shards, selection, sources, .. } =
            self;
        let Selection { seed: _, set, parts, variants, points } = selection;
        let all = |names: &[String]| if names.is_empty() { "all".to_owned() } else { names.join(",") };
        let (campaign, scenarios) =
            sources.split_first().map_or((String::new(), &[][..]), |(first, rest)| (first.sha256(), rest));
        let scenarios: Vec<_> = scenarios.iter().map(Source::sha256).collect();
        vec![
            ("version", lashloop.clone()),
            ("number of shards", shards.to_string()),
            ("campaign file's SHA-256", campaign),
            ("scenarios' SHA-256", scenarios.join(",")),
            ("seed", seed.to_string()),
            ("list of settings", format!("{set:?}")),
            ("list of parts", all(parts)),
            ("list of variants", all(variants)),
            (
                "number of points",
                points.map_or_else(|| "that of the file".to_owned(), |points| points.to_string()),
            ),
            ("number of cases", cases.to_string()),
            ("device", device.clone()),
            ("drive", drive.clone()),
            ("program's SHA-256", program_sha256.clone()),
        ]
    }
}
