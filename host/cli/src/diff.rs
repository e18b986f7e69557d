//! `lashloop diff`: two records compared.

use std::path::PathBuf;

use clap::Args;
use lashloop_bench::verdict::Exit;
use lashloop_record::diff::{
    Agreement, Comparison, DiffOptions, RecordFiles, ToleranceOf, Tolerances, settings,
};
use lashloop_report::page;

use super::error::CliError;
use super::output::{outln, print_json, write_file};
use super::report::name_among;
use lashloop::Bench;

/// Compare two records: what was set differently, the metrics, the first and the largest differences
///
/// Results are judged, settings are not: the same results on two devices are equal. Exit code 0 for equal results, 1 for
/// different ones, 2 for records that can't be compared.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of the first record
    #[arg(value_name = "A")]
    first: PathBuf,

    /// Folder of the second record
    #[arg(value_name = "B")]
    second: PathBuf,

    #[command(flatten)]
    judged: JudgedOptions,

    /// Compare from this time on, in s; metrics and verdict, which are of the whole run, are not judged
    #[arg(long, value_name = "S")]
    from: Option<f64>,

    /// Compare up to this time, in s
    #[arg(long, value_name = "S")]
    until: Option<f64>,

    /// File for both records as a page for a browser
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,

    /// Judge only what is the same in each repetition of a run in real time
    #[arg(long)]
    deterministic: bool,
}

#[derive(Args)]
pub(super) struct JudgedOptions {
    /// Largest difference of a signal or metric, in its unit or in percent: torque_nm=0.01, static_error_rad=5%; or 1% for
    /// all; repeatable [default: equal bits]
    #[arg(long, value_name = "[NAME=]VALUE")]
    pub(super) tolerance: Vec<ToleranceOf>,

    /// Signals and metrics to compare [default: all, and the verdict]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub(super) only: Vec<String>,

    /// Print the comparison as JSON
    #[arg(long)]
    pub(super) json: bool,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let (from, until) = (self.from.unwrap_or(f64::NEG_INFINITY), self.until.unwrap_or(f64::INFINITY));
        if from.is_nan() || until.is_nan() || from >= until {
            return Err(CliError::Nothing { from, until });
        }
        let JudgedOptions { tolerance, only, json } = self.judged;
        let options = DiffOptions {
            tolerances: Tolerances(tolerance),
            only,
            window_s: from..=until,
            deterministic: self.deterministic,
        };
        let records = RecordFiles::read_both([&self.first, &self.second])?;
        let comparison = Comparison::new(&records, &options)?;
        if let Some(path) = &self.html {
            let settings = settings(&records);
            let folders = [self.first, self.second];
            let runs =
                records.map(|files| page::Run::new(name_among(&folders, &files.record.folder), files.record));
            write_file(path, &page::diff(&runs, &settings, &comparison, &options))?;
        }
        print(&comparison, json)
    }
}

/// Prints a comparison; its result is the exit code.
pub(super) fn print(comparison: &Comparison, json: bool) -> Result<Exit, CliError> {
    if json {
        print_json(comparison)?;
    } else {
        outln!("{comparison}");
    }
    Ok(match comparison.agreement {
        Agreement::Bits | Agreement::Tolerance => Exit::Pass,
        Agreement::Different => Exit::Fail,
    })
}
