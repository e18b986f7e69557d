//! Reads the record of a run, also of an interrupted one.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use lashloop_plant::Signal;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::columns::Columns;
use crate::file_names::{COLUMNS_FILE, TIMING_FILE, TRACE_FILE};
use crate::summary::SUMMARY_FILE;
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
    /// `trace.csv`, with the units of `trace.json`.
    pub trace: Table,
    /// `timing.csv`, if it exists.
    pub timing: Option<Table>,
    /// Head of `summary.json`, if the run has a verdict.
    pub summary: Option<SummaryHead>,
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

/// An unusable record: file, line and reason.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", path.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Counted from 1; `None` for an error of the whole file.
    pub line: Option<u64>,
    /// What is wrong.
    pub fault: ReadFault,
}

/// Reasons for an unusable record.
#[derive(Debug, thiserror::Error)]
pub enum ReadFault {
    /// The file can't be read.
    #[error("can't be read: {0}")]
    Read(#[from] io::Error),
    /// A row with another number of fields than the header.
    #[error("fields in this row: {found}; the header has {columns} columns")]
    Fields {
        /// Fields in the row.
        found: usize,
        /// Columns of the header.
        columns: usize,
    },
    /// A field that isn't a number.
    #[error("{column} is {found:?}; it must be a number")]
    NotANumber {
        /// The column.
        column: String,
        /// The field.
        found: String,
    },
    /// A missing column.
    #[error("there is no column {column}; this is not a file that `lashloop run --out` has written")]
    Column {
        /// The column.
        column: String,
    },
    /// A table without rows.
    #[error("has no rows: the run was cut short before its first rows reached the disk")]
    Empty,
    /// Not CSV.
    #[error("is not a table: {0}")]
    Csv(#[from] csv::Error),
    /// Not a summary.
    #[error("is not the summary of a run: {0}")]
    Summary(serde_json::Error),
    /// Not a list of columns.
    #[error("is not the list of a trace's columns: {0}")]
    Columns(serde_json::Error),
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
                let number = field.trim().parse().map_err(|_| {
                    let column = signal.name.to_string();
                    error(line, ReadFault::NotANumber { column, found: field.to_owned() })
                })?;
                numbers.push(number);
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
    /// `trace.csv` is missing or has no rows, or one of the files is unusable.
    pub fn read(folder: &Path) -> Result<Self, ReadError> {
        let mut trace = Table::read(&folder.join(TRACE_FILE))?;
        if trace.is_empty() {
            return Err(ReadError { path: trace.path, line: None, fault: ReadFault::Empty });
        }
        if let Some(list) = if_it_exists(ColumnList::read(&folder.join(COLUMNS_FILE)))? {
            for ListedColumn { name, unit } in list.columns {
                trace.columns.set_unit(&name, unit);
            }
        }
        let timing = if_it_exists(Table::read(&folder.join(TIMING_FILE)))?;
        let summary = if_it_exists(SummaryHead::read(&folder.join(SUMMARY_FILE)))?;
        Ok(Self { trace, timing, summary })
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
