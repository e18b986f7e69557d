//! A record in another format: chosen columns, every n-th step, a part of the time.

use std::fs::File;
use std::io;
use std::path::Path;

use lashloop_bench::atomic_file::{WriteError, write_whole_at};
use lashloop_session::names::UnknownName;

use crate::columns::Columns;
use crate::file_names::{EXPORT_FILES, SAMPLES_FILE};
use crate::folder::RecordFolder;
use crate::reader::Record;
use crate::samples::{copy_with_index, write_table};
use crate::trace::TIME;

/// What of a record is exported.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Columns besides the time; all columns, and those of the timing, if empty.
    pub signals: Vec<String>,
    /// Every n-th step, from the first one in the range; 0 counts as 1.
    pub every: usize,
    /// The first time.
    pub from_s: f64,
    /// The last time.
    pub until_s: f64,
}

/// A format to export to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Text with the digits that restore every bit.
    Csv,
    /// Apache Parquet; only with the feature `parquet`.
    Parquet,
    /// MCAP: all messages of the run, or one message per row of a selection.
    Mcap,
    /// ASAM MDF 4.
    Mf4,
}

/// Why a record can't be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// No column has this name.
    #[error("{}: {}", .0.name, .0)]
    Unknown(#[from] UnknownName),
    /// Nothing is selected.
    #[error("no step of the record lies from {from_s} s to {until_s} s; it ends at {end_s} s")]
    Nothing {
        /// The first time asked for.
        from_s: f64,
        /// The last time asked for.
        until_s: f64,
        /// The last time of the record.
        end_s: f64,
    },
    /// The program was built without Parquet.
    #[error(
        "this lashloop has no Parquet; build it with the feature: cargo build --release -p lashloop-cli --features parquet"
    )]
    NoParquet,
    /// The file can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl Selection {
    /// Every column of every step.
    const fn all() -> Self {
        Self { signals: Vec::new(), every: 1, from_s: f64::NEG_INFINITY, until_s: f64::INFINITY }
    }

    /// Whether it has every column of every step.
    fn is_all(&self) -> bool {
        self.signals.is_empty() && self.every <= 1 && self.from_s <= 0.0 && self.until_s == f64::INFINITY
    }

    /// The columns and rows selected, the time first.
    ///
    /// # Errors
    /// A signal is unknown, or no row is selected.
    pub fn of(&self, record: &Record) -> Result<Columns, ExportError> {
        let Record { trace, timing, .. } = record;
        let all = || {
            // The first one is the number of the step.
            let timing = timing.signals().iter().skip(1).map(|signal| (timing, signal));
            trace.signals().iter().map(|signal| (trace, signal)).chain(timing)
        };
        let column = |name: &String| {
            let known = || all().map(|(_, signal)| &*signal.name);
            all()
                .find(|(_, signal)| signal.name == *name)
                .ok_or_else(|| UnknownName::new("the record", "signal", name, known()))
        };
        let chosen = match &self.signals[..] {
            [] => all().collect(),
            names => {
                let names = names.iter().filter(|name| *name != TIME);
                let time = all().find(|(_, signal)| signal.name == TIME);
                time.into_iter().map(Ok).chain(names.map(column)).collect::<Result<Vec<_>, _>>()?
            }
        };
        let time_s = trace.get(TIME).unwrap_or_default();
        let range = self.from_s..=self.until_s;
        let rows = (0..time_s.len()).filter(|row| range.contains(&time_s[*row]));
        let rows: Vec<_> = rows.step_by(self.every.max(1)).collect();
        if rows.is_empty() {
            let end_s = time_s.last().copied().unwrap_or(f64::NAN);
            return Err(ExportError::Nothing { from_s: self.from_s, until_s: self.until_s, end_s });
        }
        Ok(Columns::from_parts(chosen.into_iter().map(|(table, signal)| {
            let values = table.get(&signal.name).unwrap_or_default();
            (signal.clone(), rows.iter().map(|row| values.get(*row).copied().unwrap_or(f64::NAN)).collect())
        })))
    }
}

/// Writes a selection of a record to a file; returns its columns. An older file stays until the new one is whole.
///
/// # Errors
/// The selection is empty, the file can't be written, or the format isn't part of this build.
pub fn export(
    record: &Record,
    selection: &Selection,
    format: Format,
    path: &Path,
) -> Result<Columns, ExportError> {
    let columns = selection.of(record)?;
    let whole = |write: &dyn Fn(&Path) -> Result<(), WriteError>| write_whole_at(path, ".export-", write);
    match format {
        Format::Csv => whole(&|path| csv(&columns, path))?,
        Format::Mcap if selection.is_all() => {
            whole(&|path| copy_with_index(&record.folder.join(SAMPLES_FILE), path))?;
        }
        Format::Mcap => whole(&|path| write_table(&columns, record.manifest.step_times(), path))?,
        Format::Mf4 => whole(&|path| crate::mf4::write(record, &columns, path))?,
        #[cfg(feature = "parquet")]
        Format::Parquet => whole(&|path| crate::parquet::write(&columns, path))?,
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => return Err(ExportError::NoParquet),
    }
    Ok(columns)
}

/// Writes every column of a record to `export.csv` in its folder; nothing for a run without a step.
///
/// # Errors
/// The record can't be read, or the file can't be written.
pub fn csv_in_folder(folder: &Path) -> Result<(), WriteError> {
    let path = folder.join(EXPORT_FILES[0]);
    let failed =
        |error: String| WriteError { path: path.clone(), action: "written", source: io::Error::other(error) };
    let record = Record::read_any(folder).map_err(|error| failed(error.to_string()))?;
    match Selection::all().of(&record) {
        Ok(columns) => RecordFolder::remove_detour(&path)
            .and_then(|()| write_whole_at(&path, ".export-", |path| csv(&columns, path))),
        Err(ExportError::Nothing { .. }) => Ok(()),
        Err(error) => Err(failed(error.to_string())),
    }
}

pub(crate) fn csv(columns: &Columns, path: &Path) -> Result<(), WriteError> {
    let error = |action| move |source| WriteError { path: path.to_owned(), action, source };
    let file = File::create(path).map_err(error("created"))?;
    let written = rows(columns, csv::Writer::from_writer(file));
    written.map_err(io::Error::from).map_err(error("written"))
}

/// A NaN leaves its field empty.
fn rows(columns: &Columns, mut table: csv::Writer<File>) -> csv::Result<()> {
    table.write_record(columns.signals().iter().map(|signal| &*signal.name))?;
    let mut number = zmij::Buffer::new();
    for row in 0..columns.len() {
        for value in columns.row(row) {
            table.write_field(if value.is_nan() { "" } else { number.format(value) })?;
        }
        table.write_record(None::<&[u8]>)?;
    }
    Ok(table.flush()?)
}
