//! Shards to one table, in the order of cases, with the memory of one line per shard.

use std::fs::{self, File};
use std::io::{self, BufRead as _, BufReader, BufWriter, Read as _, Write as _};
use std::path::{Path, PathBuf};

use lashloop_bench::atomic_file::{remove_if_present, write_whole};
use lashloop_bench::regular_file::RegularFile;
use lashloop_bench::resume::{self, ResumeError};
use lashloop_bench::run::digest::hexadecimal;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use sha2::{Digest as _, Sha256};

use crate::error::{CampaignError, io_error};
use crate::facts::{CAMPAIGN, Facts};
use crate::row::{case_of, count_fields};
use crate::shard::Shard;
use crate::shard_file::{LONGEST_LINE, complete_path, facts_path, growing_path, shards_in};

/// The merged table.
pub const RESULTS: &str = "results.csv";

/// Buffer of a shard: thousands of shards may be open at once.
const BUFFER: usize = 1 << 14;
/// Files that are open besides the shards, with a margin.
const OTHER_FILES: u64 = 64;

/// Prefixes of the temporary files of a merge and its reports.
const UNFINISHED: [&str; 4] = [".results-", ".facts-", ".report-", ".output-"];

/// Excludes a second merge in a folder, until it is dropped.
#[derive(Debug)]
pub struct MergeLock(#[expect(dead_code, reason = "the open file is the lock")] File);

impl MergeLock {
    /// # Errors
    /// Another program merges in the folder, or the file of the lock can't be created.
    pub fn take(folder: &Path) -> Result<Self, CampaignError> {
        let path = folder.join(".merge.lock");
        let file = File::create(&path).map_err(io_error(&path, "created"))?;
        if !resume::lock(&file).map_err(io_error(&path, "locked"))? {
            return Err(ResumeError::InUse { path: folder.to_owned() }.into());
        }
        Ok(Self(file))
    }
}

/// Removes what killed merges left. Of complete shards no program writes facts.
fn remove_unfinished(folder: &Path) -> Result<(), CampaignError> {
    for entry in fs::read_dir(folder).map_err(io_error(folder, "read"))? {
        let entry = entry.map_err(io_error(folder, "read"))?;
        if UNFINISHED.iter().any(|prefix| entry.file_name().to_string_lossy().starts_with(prefix)) {
            remove_if_present(&entry.path())?;
        }
    }
    Ok(())
}

/// Merges the shards in a folder to `results.csv` and `campaign.json`, under the caller's [`MergeLock`].
///
/// # Errors
/// A shard is missing or incomplete, differs from the first in a fact, or lacks, repeats or adds a case.
pub fn merge(folder: &Path) -> Result<Facts, CampaignError> {
    let Shards { first, facts, hashes } = shards(folder)?;
    remove_unfinished(folder)?;
    allow_open_files(folder, facts.shards)?;
    let mut tables = Vec::new();
    for (number, table_sha256) in (1..).zip(hashes) {
        let Some(shard) = Shard::new(number, facts.shards) else { continue };
        let path = complete_path(folder, shard);
        let table = RegularFile::open(&path).map_err(io_error(&path, "read"))?;
        let table = BufReader::with_capacity(BUFFER, table.file);
        tables.push(Lines {
            shard,
            path,
            table,
            table_sha256,
            hash: Sha256::new(),
            line: 0,
            text: Vec::new(),
        });
    }
    let header = tables[0].next()?.to_vec();
    let fields = count_fields(header.trim_ascii_end());
    for table in &mut tables[1..] {
        if table.next()? != header {
            let (what, there, here) = ("header", "another".to_owned(), "another".to_owned());
            return Err(CampaignError::Mixed { shard: table.shard, first, what, there, here });
        }
    }
    try_write_whole(&folder.join(RESULTS), ".results-", |file| {
        let mut out = BufWriter::with_capacity(1 << 16, file);
        out.write_all(&header)?;
        for case in 0..facts.cases {
            let table = &mut tables[(case % u64::from(facts.shards)) as usize];
            match table.row(case, fields) {
                Ok(line) => out.write_all(line)?,
                Err(error) => return Ok(Err(error)),
            }
        }
        for table in &mut tables {
            if let Err(error) = table.end() {
                return Ok(Err(error));
            }
        }
        out.flush().map(Ok)
    })?;
    facts.write(&folder.join(CAMPAIGN))?;
    Ok(facts)
}

/// As [`write_whole`], for a writer that also reads what may be unusable.
///
/// # Errors
/// As [`write_whole`], or the error inside.
pub(crate) fn try_write_whole(
    path: &Path,
    prefix: &str,
    write: impl FnOnce(&mut File) -> io::Result<Result<(), CampaignError>>,
) -> Result<(), CampaignError> {
    let mut failure = None;
    let written = write_whole(path, prefix, |file| {
        let Err(error) = write(file)? else { return Ok(()) };
        failure = Some(error);
        Err(io::Error::other("what it is made of can't be read"))
    });
    failure.map_or_else(|| Ok(written?), Err)
}

/// The facts of the shards in a folder.
///
/// # Errors
/// A shard is missing or incomplete, or differs from the first in a fact.
pub fn common_facts(folder: &Path) -> Result<Facts, CampaignError> {
    Ok(shards(folder)?.facts)
}

/// The shards of a campaign.
struct Shards {
    first: Shard,
    /// What they have in common.
    facts: Facts,
    /// SHA-256 of each table.
    hashes: Vec<Option<String>>,
}

/// Raises the soft limit of open files as far as the shards need.
fn allow_open_files(folder: &Path, shards: u32) -> Result<(), CampaignError> {
    let wanted = u64::from(shards) + OTHER_FILES;
    let limits = getrlimit(Resource::Nofile);
    if limits.current.is_none_or(|current| current >= wanted) {
        return Ok(());
    }
    let raised = Rlimit { current: Some(wanted), maximum: limits.maximum };
    setrlimit(Resource::Nofile, raised).map_err(|_| CampaignError::OpenFiles {
        folder: folder.to_owned(),
        shards,
        limit: limits.maximum.unwrap_or(wanted),
        wanted,
    })
}

/// The shards in a folder.
fn shards(folder: &Path) -> Result<Shards, CampaignError> {
    let found = shards_in(folder)?;
    let Some(first) = found.first().copied() else {
        return Err(CampaignError::NoShards { folder: folder.to_owned() });
    };
    let incomplete = |shard, state| CampaignError::Incomplete { folder: folder.to_owned(), shard, state };
    if let Some(other) = found.iter().find(|shard| shard.count != first.count) {
        let (there, here) = (other.count.to_string(), first.count.to_string());
        return Err(CampaignError::Mixed { shard: *other, first, what: "number of shards", there, here });
    }
    let mut common: Option<Facts> = None;
    let mut hashes = Vec::new();
    for shard in (1..=first.count).filter_map(|number| Shard::new(number, first.count)) {
        if !complete_path(folder, shard).exists() {
            let state = if growing_path(folder, shard).exists() { "incomplete" } else { "missing" };
            return Err(incomplete(shard, state));
        }
        let mut facts = Facts::read(&facts_path(folder, shard))?;
        hashes.push(facts.table_sha256.take());
        match &common {
            None => common = Some(facts),
            Some(common) => {
                if let Some((what, there, here)) = facts.difference(common) {
                    return Err(CampaignError::Mixed { shard, first, what, there, here });
                }
            }
        }
    }
    match common {
        Some(facts) if facts.shards == first.count => Ok(Shards { first, facts, hashes }),
        _ => Err(incomplete(first, "of another number of shards than its name")),
    }
}

/// The lines of a shard.
struct Lines {
    shard: Shard,
    path: PathBuf,
    /// Of the table as it was completed.
    table_sha256: Option<String>,
    hash: Sha256,
    table: BufReader<File>,
    /// Number of the last line, from 1.
    line: u64,
    text: Vec<u8>,
}

impl Lines {
    fn next(&mut self) -> Result<&[u8], CampaignError> {
        self.text.clear();
        self.line += 1;
        let read = self.table.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut self.text);
        let count = read.map_err(|error| self.malformed(format!("can't be read: {error}")))?;
        if count > 0 && !self.text.ends_with(b"\n") {
            return Err(self.malformed("the line has no end".to_owned()));
        }
        self.hash.update(&self.text);
        Ok(&self.text)
    }

    fn row(&mut self, case: u64, fields: usize) -> Result<&[u8], CampaignError> {
        self.next()?;
        match case_of(&self.text, fields) {
            Some(found) if found == case => Ok(&self.text),
            Some(found) if found < case => {
                Err(self.malformed(format!("case {found} again, expected case {case}")))
            }
            Some(found) => Err(self.malformed(format!("case {found}, and case {case} is missing"))),
            None if self.text.is_empty() => Err(self.malformed(format!("case {case} is missing"))),
            None => Err(self.malformed(format!("isn't a whole row of {fields} fields"))),
        }
    }

    fn end(&mut self) -> Result<(), CampaignError> {
        if !self.next()?.is_empty() {
            return Err(self.malformed("a row after the last case".to_owned()));
        }
        let hash = hexadecimal(self.hash.clone());
        if self.table_sha256.as_ref() == Some(&hash) {
            return Ok(());
        }
        let complete = self.table_sha256.clone().unwrap_or_else(|| "not recorded".to_owned());
        Err(CampaignError::Changed { path: self.path.clone(), shard: self.shard, complete, now: hash })
    }

    fn malformed(&self, problem: String) -> CampaignError {
        CampaignError::Malformed { path: self.path.clone(), shard: self.shard, line: self.line, problem }
    }
}
