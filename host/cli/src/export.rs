//! `lashloop export`: a record as CSV, Parquet, MCAP or MF4.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lashloop_bench::verdict::Exit;
use lashloop_record::export::{Format, Selection, export};
use lashloop_record::file_names::EXPORT_FILES;
use lashloop_record::folder::RecordFolder;
use lashloop_record::reader::Record;
use lashloop_session::counted;

use super::error::CliError;
use super::output::{outln, warn};
use lashloop::Bench;

/// Write a record as CSV, Parquet, MCAP or MF4, with chosen signals and every n-th step
///
/// Numbers have all their bits. Without --signal, the file has every column of the run and its timing. MCAP without a
/// selection is a copy of run.mcap with all topics; it has an index even if the run was interrupted.
/// MF4 has what happened in the run as events.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of the record
    #[arg(value_name = "DIR")]
    record: PathBuf,

    /// Format; parquet is a feature of the build
    #[arg(long, value_name = "FORMAT")]
    to: To,

    /// Columns besides the time, such as twist_rad or drive.load_error_rad [default: all]
    #[arg(long = "signal", value_name = "NAME", num_args = 1..)]
    signals: Vec<String>,

    /// Every n-th step
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,

    /// Start of the exported time, in s
    #[arg(long, default_value_t = 0.0, value_name = "S")]
    from: f64,

    /// End of the exported time, in s [default: end of the record]
    #[arg(long, default_value_t = f64::INFINITY, value_name = "S", hide_default_value = true)]
    until: f64,

    /// File [default: export.csv, export.parquet, export.mcap or export.mf4 in the folder of the record]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum To {
    Csv,
    Parquet,
    Mcap,
    Mf4,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let (from, until) = (self.from, self.until);
        if from.is_nan() || until.is_nan() || from >= until {
            return Err(CliError::Nothing { from, until });
        }
        let record = Record::read(&self.record)?;
        if let Some(interrupted) = record.interruption() {
            warn(format_args!("{}: {interrupted}", self.record.display()));
        }
        let every = self.every as usize;
        let selection = Selection { signals: self.signals, every, from_s: from, until_s: until };
        let [csv, parquet, mcap, mf4] = EXPORT_FILES;
        let (format, name) = match self.to {
            To::Csv => (Format::Csv, csv),
            To::Parquet => (Format::Parquet, parquet),
            To::Mcap => (Format::Mcap, mcap),
            To::Mf4 => (Format::Mf4, mf4),
        };
        let path = match self.out {
            Some(path) => path,
            None => {
                let path = self.record.join(name);
                RecordFolder::remove_detour(&path)?;
                path
            }
        };
        RecordFolder::check_output(&path)?;
        let columns = export(&record, &selection, format, &path)?;
        let rows = counted(columns.len() as u64, "row");
        outln!("{rows} of {}: {}", counted(columns.signals().len() as u64, "column"), path.display());
        Ok(Exit::Pass)
    }
}
