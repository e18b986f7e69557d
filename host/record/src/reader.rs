//! Reads the record of a run, also of an interrupted one.

use std::fmt;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use lashloop_plant::Signal;
use lashloop_plant::metrics::DRIVE_PREFIX;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::columns::Columns;
use crate::failure::Failure;
use crate::file_names::{
    COLUMNS_FILE, FAILURE_FILE, MANIFEST_FILE, SAMPLES_FILE, SUMMARY_FILE, TIMING_FILE, TRACE_FILE,
};
use crate::manifest::Manifest;
pub use crate::read_error::{ReadError, ReadFault};
use crate::row::Row;
use crate::samples::{RecordedEdge, RecordedText, Samples, SamplesError};
use crate::trace::TELEMETRY_TIME;
use lashloop_bench::scenario::RunMode;

/// A table of numbers from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    path: PathBuf,
    /// The columns. Their units are in another file: [`Record::read`] adds those of the trace.
    pub columns: Columns,
    /// Whether the last line had no end and was omitted.
    pub is_torn: bool,
}

/// The folder of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Where it is.
    pub folder: PathBuf,
    /// The manifest; `None` in format 1.
    pub manifest: Option<Manifest>,
    /// The columns of the run with their units: of `run.mcap`, or of `trace.csv` without it.
    pub trace: Table,
    /// Timing of each step, if it was recorded.
    pub timing: Option<Table>,
    /// Begins and ends of injected faults; none without `run.mcap`.
    pub faults: Vec<RecordedEdge>,
    /// Texts of the drive; none without `run.mcap`.
    pub logs: Vec<RecordedText>,
    /// Head of `summary.json`, if the run has a verdict.
    pub summary: Option<SummaryHead>,
    /// Why there is no summary; `None` for a run that was killed, and with a summary.
    pub failure: Option<Failure>,
}

/// Whether a record has all that its run was to leave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Completeness {
    /// The run has ended by itself and has its summary.
    Complete,
    /// There is no summary: the run was interrupted, or is still going on.
    Interrupted {
        /// The steps up to the last whole chunk.
        steps: usize,
        /// Whether a chunk or a row after them was cut and is omitted.
        is_cut: bool,
    },
}

impl fmt::Display for Completeness {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Complete => out.write_str("complete"),
            Self::Interrupted { steps, is_cut } => {
                let cut = if *is_cut { "; what follows is cut and omitted" } else { "" };
                write!(out, "interrupted: no {SUMMARY_FILE}, {steps} steps reached the disk{cut}")
            }
        }
    }
}

/// The part of a [`Summary`](crate::summary::Summary) that identifies the run and its result.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SummaryHead {
    /// PASS, FAIL or INVALID.
    pub verdict: String,
    /// The scenario's file.
    pub scenario: String,
    /// The drive.
    pub device: String,
    /// The mode; absent in HIL mode.
    #[serde(default)]
    pub mode: RunMode,
    /// The control law.
    pub controller: String,
    /// `complete`, or what interrupted the run.
    pub end: String,
    /// Injected faults.
    pub faults: Vec<FiredFault>,
}

/// An injected fault.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct FiredFault {
    /// Name of its kind.
    pub kind: String,
    /// The step in which it began.
    pub step: usize,
}

impl Table {
    /// Reads a file. A last line without a line end is omitted: a run that is killed during a write leaves one.
    ///
    /// # Errors
    /// The file can't be read or is not a table of numbers.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let error = |line, fault| ReadError { path: path.to_owned(), line, fault };
        let mut text = fs::read(path).map_err(|source| error(None, source.into()))?;
        let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let is_torn = whole < text.len();
        text.truncate(whole);

        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(&text[..]);
        let header = reader.headers().map_err(|source| error(None, source.into()))?;
        let signal = |name: &str| Signal { name: name.to_owned().into(), unit: "".into() };
        let mut columns = Columns::new(header.iter().map(signal).collect());
        let mut numbers = Vec::new();
        for row in reader.records() {
            let row =
                row.map_err(|source| error(source.position().map(csv::Position::line), source.into()))?;
            let line = row.position().map(csv::Position::line);
            let width = columns.signals().len();
            if row.len() != width {
                return Err(error(line, ReadFault::Fields { found: row.len(), columns: width }));
            }
            numbers.clear();
            for (field, signal) in row.iter().zip(columns.signals()) {
                let number = match field.trim() {
                    "" => Ok(f64::NAN),
                    field => field.parse(),
                };
                numbers.push(number.map_err(|_| {
                    let column = signal.name.to_string();
                    error(line, ReadFault::NotANumber { column, found: field.to_owned() })
                })?);
            }
            columns.push(numbers.iter().copied());
        }
        Ok(Self { path: path.to_owned(), columns, is_torn })
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether the table has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// All rows, each column by its name. Further columns are ignored.
    ///
    /// # Errors
    /// The table lacks a column.
    pub fn rows<R: Row>(&self) -> Result<Vec<R>, ReadError> {
        let columns = R::COLUMNS.iter().map(|(name, _)| self.column(name)).collect::<Result<Vec<_>, _>>()?;
        let row = |row: usize| {
            let mut values = columns.iter().map(|column| column[row]);
            R::of(|| values.next().unwrap_or(f64::NAN))
        };
        Ok((0..self.len()).map(row).collect())
    }

    /// A column by its name.
    ///
    /// # Errors
    /// The table has no column of this name.
    pub fn column(&self, name: &str) -> Result<&[f64], ReadError> {
        self.columns.get(name).ok_or_else(|| {
            let fault = ReadFault::Column { column: name.to_owned() };
            ReadError { path: self.path.clone(), line: None, fault }
        })
    }
}

impl Record {
    /// Reads the folder that a run wrote with `--out`.
    ///
    /// # Errors
    /// There are neither samples nor a trace, they have no rows, or one of the files is unusable.
    pub fn read(folder: &Path) -> Result<Self, ReadError> {
        let record = Self::read_any(folder)?;
        if record.trace.is_empty() { Err(record.no_rows()) } else { Ok(record) }
    }

    /// Reads the folder of a run that may have ended before its first torque.
    ///
    /// # Errors
    /// There are neither samples nor a trace, or one of the files is unusable.
    pub fn read_any(folder: &Path) -> Result<Self, ReadError> {
        let manifest = if_it_exists(read_json(&folder.join(MANIFEST_FILE), ReadFault::Manifest))?;
        let samples = if_it_exists(read_samples(&folder.join(SAMPLES_FILE)))?;
        let tables = || -> Result<_, ReadError> {
            Ok((read_trace(folder)?, if_it_exists(read_timing(&folder.join(TIMING_FILE)))?))
        };
        let (trace, timing, faults, logs) = match samples {
            Some(Samples { trace, timing, faults, logs, is_torn }) => {
                let table = |columns| Table { path: folder.join(SAMPLES_FILE), columns, is_torn };
                let rows = if trace.is_empty() { if_it_exists(tables())? } else { None };
                // A chunk of the tables is written before that of the samples.
                match rows {
                    Some((rows, timing)) if !rows.is_empty() => (rows, timing, faults, logs),
                    _ => (table(trace), Some(table(timing)), faults, logs),
                }
            }
            None => {
                let (trace, timing) = tables()?;
                (trace, timing, Vec::new(), Vec::new())
            }
        };
        let summary = if_it_exists(SummaryHead::read(&folder.join(SUMMARY_FILE)))?;
        let failure = if_it_exists(read_json(&folder.join(FAILURE_FILE), ReadFault::Failure))?;
        let failure = failure.filter(|_| summary.is_none());
        Ok(Self { folder: folder.to_owned(), manifest, trace, timing, faults, logs, summary, failure })
    }

    /// The error of a record without rows.
    #[must_use]
    pub fn no_rows(&self) -> ReadError {
        ReadError { path: self.trace.path.clone(), line: None, fault: ReadFault::Empty }
    }

    /// Whether the columns are those of `run.mcap`, which has every bit.
    #[must_use]
    pub fn is_of_samples(&self) -> bool {
        self.trace.path.ends_with(SAMPLES_FILE)
    }

    /// Whether the record has all that its run was to leave.
    #[must_use]
    pub fn completeness(&self) -> Completeness {
        let is_cut = self.trace.is_torn || self.timing.as_ref().is_some_and(|timing| timing.is_torn);
        match self.summary {
            Some(_) => Completeness::Complete,
            None => Completeness::Interrupted { steps: self.trace.len(), is_cut },
        }
    }
}

impl SummaryHead {
    /// Reads a summary.
    ///
    /// # Errors
    /// The file can't be read or isn't a summary.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        read_json(path, ReadFault::Summary)
    }
}

/// The content of `trace.json`.
#[derive(Debug, Deserialize)]
struct ColumnList {
    columns: Vec<ListedColumn>,
}

#[derive(Debug, Deserialize)]
struct ListedColumn {
    name: String,
    unit: String,
}

impl ColumnList {
    fn read(path: &Path) -> Result<Self, ReadError> {
        read_json(path, ReadFault::Columns)
    }
}

fn read_samples(path: &Path) -> Result<Samples, ReadError> {
    Samples::read(path).map_err(|error| {
        let fault = match error {
            SamplesError::Read(source) => ReadFault::Read(source),
            other => ReadFault::Samples(other),
        };
        ReadError { path: path.to_owned(), line: None, fault }
    })
}

/// `trace.csv`, with the units of `trace.json` and the drive's signals repeated until the next telemetry.
fn read_trace(folder: &Path) -> Result<Table, ReadError> {
    let mut trace = Table::read(&folder.join(TRACE_FILE))?;
    if let Some(list) = if_it_exists(ColumnList::read(&folder.join(COLUMNS_FILE)))? {
        for ListedColumn { name, unit } in list.columns {
            trace.columns.set_unit(&name, unit);
        }
    }
    let signals = trace.columns.signals().iter().map(|signal| signal.name.to_string());
    let of_telemetry = signals.filter(|name| name.starts_with(DRIVE_PREFIX) || name == TELEMETRY_TIME);
    let of_telemetry: Vec<_> = of_telemetry.collect();
    trace.columns.repeat_telemetry(&of_telemetry, TELEMETRY_TIME);
    Ok(trace)
}

/// `timing.csv`, with the number of each step.
fn read_timing(path: &Path) -> Result<Table, ReadError> {
    let mut timing = Table::read(path)?;
    timing.columns.number_rows("step");
    Ok(timing)
}

fn read_json<T: DeserializeOwned>(
    path: &Path,
    fault: fn(serde_json::Error) -> ReadFault,
) -> Result<T, ReadError> {
    let error = |fault| ReadError { path: path.to_owned(), line: None, fault };
    let text = fs::read(path).map_err(|source| error(source.into()))?;
    serde_json::from_slice(&text).map_err(|source| error(fault(source)))
}

fn if_it_exists<T>(read: Result<T, ReadError>) -> Result<Option<T>, ReadError> {
    match read {
        Ok(found) => Ok(Some(found)),
        Err(ReadError { fault: ReadFault::Read(source), .. }) if source.kind() == ErrorKind::NotFound => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Table, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.csv");
        fs::write(&path, text).expect("a file");
        Table::read(&path)
            .map_err(|error| error.to_string().replace(&folder.path().display().to_string(), ""))
    }

    #[test]
    fn a_line_without_an_end_is_omitted() {
        for torn in ["3", "3,0.12", ""] {
            let table = of(&format!("a,b\n1,2\n2,NaN\n{torn}")).expect("a table");
            assert_eq!((table.column("a").expect("a column"), table.len()), (&[1.0, 2.0][..], 2));
            assert!(table.column("b").expect("a column")[1].is_nan());
            assert_eq!(table.is_torn, !torn.is_empty());
        }
    }

    #[test]
    fn errors_name_file_and_line() {
        assert_eq!(of("a,b\n1,2\n3,x\n"), Err("/t.csv:3: b is \"x\"; it must be a number".to_owned()));
        assert_eq!(
            of("a,b\n1,2,3\n"),
            Err("/t.csv:2: fields in this row: 3; the header has 2 columns".to_owned())
        );
        let error = of("a,b\n1,2\n").expect("a table").column("c").expect_err("no such column").to_string();
        assert!(error.contains("there is no column c"), "{error}");
    }
}
