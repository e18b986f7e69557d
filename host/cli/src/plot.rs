//! `lashloop plot`: records and captures of runs as a figure.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser as _};
use lashloop::Bench;
use lashloop_bench::regular_file;
use lashloop_bench::verdict::Exit;
use lashloop_decode::series::{Series, series};
use lashloop_record::file_names::FIGURE_FILE;
use lashloop_record::reader::Record;
use lashloop_record::table;
use lashloop_report::runs::{Input, Selection, figure};

use super::error::CliError;
use super::output::{outln, write_bytes, write_in_folder};
use super::png;
use super::report::name_among;

/// Formats of the figure, by the ending of its file in small letters.
const ENDINGS: [&str; 2] = ["svg", PNG];
const PNG: &str = "png";

/// Plot records and captures: position, error, torque, gap, estimate, round trip, and any signal
///
/// A record is a folder of `run --out`, a capture a file of `run --capture`. A CSV file is what the drive has captured, scope.csv
/// in a record, with its time from the event on; or a record of `run --csv`. What an interrupted run left is plotted up to
/// its last whole row or frame. Several share the axes; each has its own colour and dash.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders of records, captures, and tables
    #[arg(required = true, value_name = "DIR|FILE.pcapng|FILE.csv")]
    records: Vec<PathBuf>,

    /// Signals to plot as well, each in a panel of its own, such as drive.requested_torque_nm; * stands for any characters
    #[arg(long = "signal", value_name = "NAME", num_args = 1..)]
    signals: Vec<String>,

    /// Signals to plot in one panel, separated by commas, such as load_position_rad,reference_rad or drive.*; one panel for
    /// each unit. Replaces the standard panels; repeatable
    #[arg(long = "panel", value_name = "NAME,...")]
    panels: Vec<String>,

    /// File for the figure, .svg or .png [default: record.svg in the first folder, or next to the first capture]
    #[arg(long, value_name = "FILE", value_parser = PathBufValueParser::new().try_map(figure_file))]
    out: Option<PathBuf>,

    /// Start of the plotted time, in s [default: start of the record]
    #[arg(
        long,
        default_value_t = f64::NEG_INFINITY,
        value_name = "S",
        hide_default_value = true,
        allow_negative_numbers = true
    )]
    from: f64,

    /// End of the plotted time, in s [default: end of the record]
    #[arg(
        long,
        default_value_t = f64::INFINITY,
        value_name = "S",
        hide_default_value = true,
        allow_negative_numbers = true
    )]
    until: f64,
}

impl Arguments {
    pub(crate) fn run(self, _: &Bench) -> Result<Exit, CliError> {
        let (from, until) = (self.from, self.until);
        if from.is_nan() || until.is_nan() || from >= until {
            return Err(CliError::Nothing { from, until });
        }
        let inputs = self
            .records
            .iter()
            .map(|path| Ok((name_among(&self.records, path), read(path)?)))
            .collect::<Result<Vec<_>, CliError>>()?;
        let panels = self.panels.iter().map(|names| names.split(',').map(str::to_owned).collect());
        let selection =
            Selection { shown_s: from..=until, signals: self.signals.clone(), panels: panels.collect() };
        let svg = figure(&inputs, &selection)?.to_svg();
        let path = match &self.out {
            Some(path) if ending(path).as_deref() == Some(PNG) => {
                write_bytes(path, &png::from_svg(&svg)?)?;
                path.clone()
            }
            Some(path) => {
                write_bytes(path, svg.as_bytes())?;
                path.clone()
            }
            None => {
                let (folder, name) = default_file(&self.records[0]);
                write_in_folder(&folder, &name, svg.as_bytes())?
            }
        };
        outln!("figure: {}", path.display());
        Ok(Exit::Pass)
    }
}

fn ending(path: &Path) -> Option<String> {
    path.extension().map(|it| it.to_string_lossy().to_ascii_lowercase())
}

/// A device such as /dev/stdout has no ending, and gets an SVG.
fn figure_file(path: PathBuf) -> Result<PathBuf, String> {
    match ending(&path) {
        Some(other) if !ENDINGS.contains(&&*other) => {
            Err(format!("a figure is an SVG or a PNG, not {other:?}: end the file in .svg or .png"))
        }
        _ => Ok(path),
    }
}

fn read(path: &Path) -> Result<Input, CliError> {
    if !path.is_file() {
        return Ok(Input::Record(Box::new(Record::read(path)?)));
    }
    if ending(path).as_deref() == Some("csv") {
        return Ok(Input::Table(table::read(path)?));
    }
    let bytes =
        regular_file::read(path).map_err(|source| CliError::Input { path: path.to_owned(), source })?;
    let Some(Series { columns, torn }) = series(&bytes) else {
        return Err(CliError::NoSteps { path: path.to_owned() });
    };
    Ok(Input::Capture { columns, torn })
}

/// Folder and name.
fn default_file(first: &Path) -> (PathBuf, String) {
    match (first.is_file(), first.file_stem()) {
        (true, Some(stem)) => {
            (first.parent().unwrap_or(Path::new("")).to_owned(), format!("{}.svg", stem.to_string_lossy()))
        }
        _ => (first.to_owned(), FIGURE_FILE.to_owned()),
    }
}
