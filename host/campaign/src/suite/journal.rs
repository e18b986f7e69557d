//! The journal of a suite: one line of JSON per result, after a first one that identifies the command.

use std::io::Read as _;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::case_result::CaseResult;
use crate::error::{CampaignError, io_error};
use crate::facts::first_difference;
use crate::results_file::ResultsFile;
use lashloop_bench::resume::ResumeError;

/// The suite that a journal belongs to. The scenarios are not part of it: a result counts if its case is unchanged.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    pub lashloop: String,
    /// SHA-256 of the program's file, which holds plant and drive.
    pub program_sha256: String,
    pub device: String,
    pub clock: String,
}

impl Header {
    /// Names and values that must be equal to resume.
    fn facts(&self) -> Vec<(&'static str, String)> {
        let Self { lashloop, program_sha256, device, clock } = self;
        vec![
            ("version", lashloop.clone()),
            ("device", device.clone()),
            ("clock", clock.clone()),
            ("program's SHA-256", program_sha256.clone()),
        ]
    }
}

/// An open journal.
#[derive(Debug)]
pub struct Journal(ResultsFile);

impl Journal {
    /// Creates a journal.
    ///
    /// # Errors
    /// The file exists, or the system refuses it.
    pub fn create(path: &Path, header: &Header) -> Result<Self, CampaignError> {
        Self::begin(ResultsFile::create(path)?, header)
    }

    /// Creates a journal, instead of an earlier one that no process writes.
    ///
    /// # Errors
    /// The earlier one is in use, or the system refuses the file.
    pub fn replace(path: &Path, header: &Header) -> Result<Self, CampaignError> {
        let mut file = ResultsFile::open(path)?;
        file.cut(0)?;
        Self::begin(file, header)
    }

    /// Opens a journal and passes its results to `take`; creates one if none exists.
    ///
    /// # Errors
    /// The journal belongs to another command, is in use, or holds a malformed line.
    pub fn resume(
        path: &Path,
        header: &Header,
        mut take: impl FnMut(CaseResult),
    ) -> Result<Self, CampaignError> {
        let mut file = ResultsFile::open(path)?;
        let mut text = String::new();
        file.file.read_to_string(&mut text).map_err(io_error(path, "read"))?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        file.cut(whole as u64)?;
        let malformed = |line: usize| {
            move |error: serde_json::Error| CampaignError::Journal {
                path: path.to_owned(),
                line,
                problem: error.to_string(),
            }
        };
        let mut lines = text[..whole].lines();
        let Some(first) = lines.next() else { return Self::begin(file, header) };
        let there: Header = serde_json::from_str(first).map_err(malformed(1))?;
        if let Some((what, there, here)) = first_difference(there.facts(), header.facts()) {
            return Err(ResumeError::Other { path: path.to_owned(), what, there, here }.into());
        }
        for (line, text) in (2..).zip(lines) {
            take(serde_json::from_str(text).map_err(malformed(line))?);
        }
        Ok(Self(file))
    }

    /// Appends a result.
    ///
    /// # Errors
    /// The write fails; the lines before it stay intact.
    pub fn append(&mut self, result: &CaseResult) -> Result<(), CampaignError> {
        self.write(result)
    }

    fn begin(file: ResultsFile, header: &Header) -> Result<Self, CampaignError> {
        let mut journal = Self(file);
        journal.write(header)?;
        Ok(journal)
    }

    fn write(&mut self, value: &impl Serialize) -> Result<(), CampaignError> {
        let mut line =
            serde_json::to_vec(value).map_err(|error| io_error(&self.0.path, "written")(error.into()))?;
        line.push(b'\n');
        self.0.append(&line)
    }
}
