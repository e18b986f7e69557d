//! `lashloop plot`: what a run did, as a picture.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use lashloop_bench::record::reader::Record;
use lashloop_bench::verdict::Exit;
use lashloop_report::runs::figure;

use super::error::CliError;
use super::output::outln;

const PICTURE: &str = "record.svg";

/// Draw the records of one run or several side by side: position, error, torque, gap, estimate, round trip.
///
/// A record is a folder that `run --out` has written, also of a run that was cut short.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders of runs
    #[arg(required = true, value_name = "DIR")]
    records: Vec<PathBuf>,

    /// The picture [default: record.svg in the first folder]
    #[arg(long, value_name = "FILE.svg")]
    out: Option<PathBuf>,

    /// Leave out what was before this time, in s
    #[arg(long, default_value_t = 0.0, value_name = "S")]
    from: f64,

    /// Leave out what was after this time, in s
    #[arg(long, default_value_t = f64::INFINITY, value_name = "S", hide_default_value = true)]
    until: f64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<Exit, CliError> {
        let (from, until) = (self.from, self.until);
        if from.is_nan() || until.is_nan() || from >= until {
            return Err(CliError::Nothing { from, until });
        }
        let runs = self
            .records
            .iter()
            .map(|folder| Ok((self.name(folder), Record::read(folder)?)))
            .collect::<Result<Vec<_>, CliError>>()?;
        let picture = figure(&runs, &(from..=until))?.to_svg();
        let path = self.out.unwrap_or_else(|| self.records[0].join(PICTURE));
        fs::write(&path, picture).map_err(|source| CliError::Output { path: path.clone(), source })?;
        outln!("picture: {}", path.display());
        Ok(Exit::Pass)
    }

    /// The last part of its path, or all of it where another folder is called the same.
    fn name(&self, folder: &Path) -> String {
        let is_alone =
            self.records.iter().filter(|other| other.file_name() == folder.file_name()).count() == 1;
        let name = folder.file_name().filter(|_| is_alone).unwrap_or(folder.as_os_str());
        name.to_string_lossy().into_owned()
    }
}
