//! `lashloop plot`: the records of runs as a figure.

use std::path::{Path, PathBuf};

use crate::bench::Bench;
use clap::Args;
use lashloop_bench::verdict::Exit;
use lashloop_record::reader::Record;
use lashloop_report::runs::{Selection, figure};

use super::error::CliError;
use super::output::{outln, write_file};

const FIGURE_FILE: &str = "record.svg";

/// Plot records: position, error, torque, gap, estimate, round trip, and any signal
///
/// A record is a folder of `run --out`. The record of an interrupted run is plotted up to its last whole row. Several
/// records share the axes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders of records
    #[arg(required = true, value_name = "DIR")]
    records: Vec<PathBuf>,

    /// Columns of trace.csv to plot as well, such as drive.requested_torque_nm
    #[arg(long = "signal", value_name = "NAME", num_args = 1..)]
    signals: Vec<String>,

    /// File for the figure [default: record.svg in the first folder]
    #[arg(long, value_name = "FILE.svg")]
    out: Option<PathBuf>,

    /// Start of the plotted time, in s
    #[arg(long, default_value_t = 0.0, value_name = "S")]
    from: f64,

    /// End of the plotted time, in s [default: end of the record]
    #[arg(long, default_value_t = f64::INFINITY, value_name = "S", hide_default_value = true)]
    until: f64,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let (from, until) = (self.from, self.until);
        if from.is_nan() || until.is_nan() || from >= until {
            return Err(CliError::Nothing { from, until });
        }
        let runs = self
            .records
            .iter()
            .map(|folder| Ok((self.name(folder), Record::read(folder)?)))
            .collect::<Result<Vec<_>, CliError>>()?;
        let selection = Selection { shown_s: from..=until, signals: self.signals.clone() };
        let svg = figure(&runs, &selection)?.to_svg();
        let path = self.out.unwrap_or_else(|| self.records[0].join(FIGURE_FILE));
        write_file(&path, &svg)?;
        outln!("figure: {}", path.display());
        Ok(Exit::Pass)
    }

    /// The last part of the path; the whole path where two folders share a name.
    fn name(&self, folder: &Path) -> String {
        let is_alone =
            self.records.iter().filter(|other| other.file_name() == folder.file_name()).count() == 1;
        let name = folder.file_name().filter(|_| is_alone).unwrap_or(folder.as_os_str());
        name.to_string_lossy().into_owned()
    }
}
