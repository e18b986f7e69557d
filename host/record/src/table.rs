//! A table as `export` writes it and a capture of the drive is: names in the first line, numbers below.

use std::path::{Path, PathBuf};

use lashloop_bench::regular_file::RegularFile;
use lashloop_bench::scenario::unit;
use lashloop_plant::Signal;

use crate::columns::Columns;
use crate::trace::TIME;

/// Why a table can't be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file can't be read, or isn't a table.
    #[error("{}: {source}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: csv::Error,
    },
    /// The first column isn't the time.
    #[error("{}: the first column is {found:?}; it must be {TIME}, as in scope.csv and export.csv", path.display())]
    NoTime {
        /// The file.
        path: PathBuf,
        /// The first name.
        found: String,
    },
    /// A field isn't a number.
    #[error("{}:{line}: {name} is {found:?}; it must be a number or empty", path.display())]
    Number {
        /// The file.
        path: PathBuf,
        /// The line.
        line: u64,
        /// The column.
        name: String,
        /// The text.
        found: String,
    },
}

/// Reads a table whose first column is the time. The end of a name is the unit; an empty field is NaN.
///
/// # Errors
/// The file can't be read or has no such table.
pub fn read(path: &Path) -> Result<Columns, TableError> {
    let error = |source| TableError::Csv { path: path.to_owned(), source };
    let reader = RegularFile::open(path).map_err(|source| error(source.into()))?;
    let mut reader = csv::Reader::from_reader(reader.file);
    let names = reader.headers().map_err(error)?.clone();
    match names.get(0) {
        Some(TIME) => {}
        other => {
            let found = other.unwrap_or_default().to_owned();
            return Err(TableError::NoTime { path: path.to_owned(), found });
        }
    }
    let signal = |name: &str| Signal { name: name.to_owned().into(), unit: unit::of(name).into() };
    let mut columns = Columns::new(names.iter().map(signal).collect());
    for record in reader.records() {
        let record = record.map_err(error)?;
        let number = |(found, name): (&str, &str)| match found {
            "" => Ok(f64::NAN),
            _ => found.parse().map_err(|_| TableError::Number {
                path: path.to_owned(),
                line: record.position().map_or(0, csv::Position::line),
                name: name.to_owned(),
                found: found.to_owned(),
            }),
        };
        columns.push(record.iter().zip(&names).map(number).collect::<Result<Vec<_>, _>>()?);
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Columns, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.csv");
        std::fs::write(&path, text).expect("a table");
        let name = path.display().to_string();
        read(&path).map_err(|error| error.to_string().replace(&name, "t.csv"))
    }

    #[test]
    fn a_table_has_the_units_of_its_names() {
        let table = read_text("time_s,drive.a_nm,drive.b\n-0.001,1,\n0,2.5,3\n").expect("a table");
        let units: Vec<_> = table.signals().iter().map(|it| &*it.unit).collect();
        assert_eq!(units, ["s", "N m", ""]);
        assert_eq!(table.get("time_s"), Some(&[-0.001, 0.0][..]));
        let b = table.get("drive.b").expect("a column");
        assert!(b[0].is_nan() && b[1] == 3.0);
    }

    #[test]
    fn a_file_that_is_no_such_table_is_an_error_at_its_place() {
        assert_eq!(
            read_text("a,b\n1,2\n").expect_err("no time"),
            "t.csv: the first column is \"a\"; it must be time_s, as in scope.csv and export.csv"
        );
        assert_eq!(
            read_text("time_s,b\n1,2\n2,x\n").expect_err("no number"),
            "t.csv:3: b is \"x\"; it must be a number or empty"
        );
        assert!(read_text("time_s,b\n1\n").is_err(), "a row that is too short");
    }
}
