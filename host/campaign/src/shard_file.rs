//! The table of a shard: `shard-K-of-N.csv.part` while it grows, `shard-K-of-N.csv` once it is complete.
//!
//! Rows are in the order of cases and each is one write. After a kill or a full disk the file is cut to its whole lines; their
//! number is the number of finished cases.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufRead as _, BufReader, ErrorKind, Read as _, Seek as _};
use std::path::{Path, PathBuf};

use lashloop_bench::atomic_file::remove_if_present;
use lashloop_bench::resume::ResumeError;
use lashloop_bench::run::digest::hexadecimal;
use sha2::{Digest as _, Sha256};

use crate::error::{CampaignError, io_error};
use crate::facts::Facts;
use crate::results_file::ResultsFile;
use crate::row::{case_of, count_fields};
use crate::shard::Shard;

/// Bytes of a line at most: keys and labels of a header are of a file of 1 MiB, and a row is shorter.
pub(crate) const LONGEST_LINE: u64 = 1 << 20;

/// The table of a shard, locked for this process.
#[derive(Debug)]
pub struct ShardFile {
    file: ResultsFile,
    complete: PathBuf,
    facts: Facts,
    facts_file: PathBuf,
    hash: Sha256,
}

/// The whole lines of a table.
#[derive(Debug, Default)]
struct Whole {
    rows: u64,
    bytes: u64,
    hash: Sha256,
}

/// A shard at its start.
#[derive(Debug)]
pub enum Opened {
    Complete,
    /// A table with this number of rows.
    Growing(Box<ShardFile>, u64),
}

/// Whether results of an earlier command are continued.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    New,
    Resume,
}

#[must_use]
pub fn complete_path(folder: &Path, shard: Shard) -> PathBuf {
    folder.join(format!("{}.csv", shard.stem()))
}

#[must_use]
pub fn growing_path(folder: &Path, shard: Shard) -> PathBuf {
    folder.join(format!("{}.csv.part", shard.stem()))
}

#[must_use]
pub fn facts_path(folder: &Path, shard: Shard) -> PathBuf {
    folder.join(format!("{}.json", shard.stem()))
}

/// Opens the table of a shard, or begins it.
///
/// # Errors
/// The folder holds results that are not to be continued, or of another campaign; or another program writes them.
pub fn open(
    folder: &Path,
    shard: Shard,
    facts: &Facts,
    header: &[u8],
    start: Start,
) -> Result<Opened, CampaignError> {
    let (complete, path, facts_file) =
        (complete_path(folder, shard), growing_path(folder, shard), facts_path(folder, shard));
    if let Some(there) = shards_in(folder)?.into_iter().find(|there| there.count != shard.count) {
        let (there, here) = (there.count.to_string(), shard.count.to_string());
        return Err(
            ResumeError::Other { path: folder.to_owned(), what: "number of shards", there, here }.into()
        );
    }
    // First, because another program may begin or complete the shard between a look at the files and the lock.
    let mut file = ResultsFile::open(&path)?;
    let is_complete = complete.exists();
    if is_complete {
        // The locked file is a new one, or the complete table under its former name.
        remove_if_present(&path)?;
    }
    // The facts are on the disk before the header. A table without it has no row.
    let is_begun = is_complete || has_line(&file.file).map_err(io_error(&path, "read"))?;
    if is_begun && start == Start::New {
        return Err(ResumeError::Exists { path: if is_complete { complete } else { path } }.into());
    }
    if is_begun && let Some((what, there, here)) = Facts::read(&facts_file)?.difference(facts) {
        return Err(ResumeError::Other { path, what, there, here }.into());
    }
    if is_complete {
        return Ok(Opened::Complete);
    }
    if !is_begun {
        facts.write(&facts_file)?;
    }
    let Whole { rows, bytes, hash } =
        whole_lines(&file.file, header, shard).map_err(io_error(&path, "read"))?;
    file.cut(bytes)?;
    let facts = facts.clone();
    let mut table = ShardFile { file, complete, facts, facts_file, hash };
    if bytes == 0 {
        table.append(header)?;
    }
    Ok(Opened::Growing(Box::new(table), rows))
}

/// The shards of which a folder has files.
///
/// # Errors
/// The folder can't be read.
pub fn shards_in(folder: &Path) -> Result<BTreeSet<Shard>, CampaignError> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder).map_err(io_error(folder, "read"))? {
        let name = entry.map_err(io_error(folder, "read"))?.file_name();
        found.extend(name.to_str().and_then(Shard::of_file_name));
    }
    Ok(found)
}

impl ShardFile {
    /// Appends a row.
    ///
    /// # Errors
    /// The write fails; the rows before it stay intact.
    pub fn append(&mut self, line: &[u8]) -> Result<(), CampaignError> {
        self.file.append(line)?;
        self.hash.update(line);
        Ok(())
    }

    /// Gives the table its name, after its bytes and their SHA-256 are on the disk.
    ///
    /// # Errors
    /// The file can't be synchronised or renamed, or its facts can't be written.
    pub fn finish(mut self) -> Result<(), CampaignError> {
        self.facts.table_sha256 = Some(hexadecimal(self.hash));
        self.facts.write(&self.facts_file)?;
        let ResultsFile { path, file, .. } = &self.file;
        file.sync_all().map_err(io_error(path, "written"))?;
        fs::rename(path, &self.complete).map_err(io_error(&self.complete, "written"))?;
        let folder = self.complete.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        File::open(folder).and_then(|folder| folder.sync_all()).map_err(io_error(folder, "written"))
    }
}

/// Whether a table has a whole line.
fn has_line(mut file: &File) -> io::Result<bool> {
    let mut first = Vec::new();
    BufReader::new((&mut file).take(LONGEST_LINE)).read_until(b'\n', &mut first)?;
    file.rewind()?;
    Ok(first.ends_with(b"\n"))
}

/// The lines up to the first one that is not the expected one. What follows it is run again, which gives the same rows.
fn whole_lines(file: &File, header: &[u8], shard: Shard) -> io::Result<Whole> {
    let mut lines = BufReader::with_capacity(1 << 16, file);
    let fields = count_fields(header);
    let (mut line, mut whole) = (Vec::new(), Whole::default());
    loop {
        line.clear();
        match lines.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line) {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            result => result?,
        };
        let is_header = whole.bytes == 0;
        let is_expected =
            if is_header { line == header } else { case_of(&line, fields) == Some(shard.case(whole.rows)) };
        if !is_expected {
            return Ok(whole);
        }
        whole.rows += u64::from(!is_header);
        whole.bytes += line.len() as u64;
        whole.hash.update(&line);
    }
}
