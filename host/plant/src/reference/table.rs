//! A reference given by points, from a CSV file with the columns `time_s,position_rad`.
//!
//! Times increase strictly. Before the first point the first position holds, after the last point the last position.
//! Lines that start with `#` are comments.

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// Interpolation between two points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// A straight line.
    Linear,
    /// The earlier position.
    Hold,
}

/// A reference given by at least one point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Source of the points.
    file: PathBuf,
    interpolation: Interpolation,
    #[serde(skip)]
    points: Vec<Point>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    time_s: f64,
    position_rad: f64,
}

/// Why a table was rejected, with file and line.
#[derive(Debug, thiserror::Error)]
#[error("table {}{}: {kind}", file.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct TableError {
    /// The file as it was opened.
    pub file: PathBuf,
    /// Line number from 1; `None` if the error concerns the whole file.
    pub line: Option<usize>,
    /// The reason.
    pub kind: TableErrorKind,
}

/// Reasons for which a table is rejected.
#[derive(Debug, thiserror::Error)]
pub enum TableErrorKind {
    /// The file can't be read.
    #[error("can't be read: {0}")]
    Read(#[source] io::Error),
    /// The first line isn't the header.
    #[error("the columns are {0:?}; they must be \"time_s,position_rad\"")]
    Header(String),
    /// A line does not have two fields.
    #[error("fields in this row: {0}; a row must have 2")]
    Fields(usize),
    /// A field isn't a number.
    #[error("{column} is {found:?}; it must be a number")]
    NotANumber {
        /// Name of the column.
        column: &'static str,
        /// Text of the field.
        found: String,
    },
    /// A number is NaN or infinite.
    #[error("{column} is {found}; it must be finite")]
    NotFinite {
        /// Name of the column.
        column: &'static str,
        /// Value of the field.
        found: f64,
    },
    /// A time isn't later than the time before it.
    #[error("time_s is {found} after {before}; times must increase")]
    NotIncreasing {
        /// Time of this line.
        found: f64,
        /// The time of the line before.
        before: f64,
    },
    /// The file has no points.
    #[error("has no points; it must have at least one")]
    Empty,
}

/// Largest file in bytes: two million points.
const LARGEST: u64 = 64 << 20;
const COLUMNS: [&str; 2] = ["time_s", "position_rad"];

impl Table {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// The file can't be read, its columns have other names, or a line lacks a finite position and a finite time after
    /// that of the line before.
    pub fn from_file(file: &Path, interpolation: Interpolation) -> Result<Self, TableError> {
        let error = |kind| TableError { file: file.to_owned(), line: None, kind };
        let read = |source| error(TableErrorKind::Read(source));
        // A pipe would keep the program waiting for a writer, and a device may have no end.
        let found = std::fs::metadata(file).map_err(read)?;
        if !found.is_file() {
            return Err(read(io::Error::other("it isn't a file")));
        }
        if found.len() > LARGEST {
            let text = format!("it has {} bytes; the limit is {LARGEST}", found.len());
            return Err(read(io::Error::other(text)));
        }
        let text = std::fs::read_to_string(file).map_err(read)?;
        Self::from_text(file, &text, interpolation)
    }

    /// As [`from_file`](Self::from_file), of a text. `file` is its source in errors.
    ///
    /// # Errors
    /// As [`from_file`](Self::from_file), except for reading the file.
    pub fn from_text(file: &Path, text: &str, interpolation: Interpolation) -> Result<Self, TableError> {
        let points =
            read_points(text).map_err(|(line, kind)| TableError { file: file.to_owned(), line, kind })?;
        Ok(Self { file: file.to_owned(), interpolation, points })
    }

    /// The same points with another interpolation.
    #[must_use]
    pub fn interpolated(self, interpolation: Interpolation) -> Self {
        Self { interpolation, ..self }
    }

    /// Source of the points.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The points as a CSV file, which reads back to the same bits.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let line = |point: &Point| format!("{:?},{:?}\n", point.time_s, point.position_rad);
        self.points.iter().map(line).fold(COLUMNS.join(",") + "\n", |text, line| text + &line)
    }

    /// Reference position in rad at a time of the run.
    #[must_use]
    pub fn position_rad(&self, t_s: f64) -> f64 {
        let after = self.points.partition_point(|point| point.time_s <= t_s);
        let (Some(next), Some(previous)) = (self.points.get(after), self.points[..after].last()) else {
            // Beyond either end; there is at least one point.
            return self.points[after.min(self.points.len() - 1)].position_rad;
        };
        match self.interpolation {
            Interpolation::Hold => previous.position_rad,
            Interpolation::Linear => {
                let fraction = (t_s - previous.time_s) / (next.time_s - previous.time_s);
                previous.position_rad + fraction * (next.position_rad - previous.position_rad)
            }
        }
    }

    /// The position farthest from zero, in rad.
    #[must_use]
    pub fn farthest_rad(&self) -> f64 {
        let positions = self.points.iter().map(|point| point.position_rad);
        positions.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or_default()
    }

    /// Half way between the lowest and the highest point, in rad.
    #[must_use]
    pub fn middle_rad(&self) -> f64 {
        let ends = self.points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], point| {
            [low.min(point.position_rad), high.max(point.position_rad)]
        });
        0.5 * (ends[0] + ends[1])
    }
}

/// We read line by line, without a CSV reader: two columns of numbers need no quoting, and a reader that skips blank
/// lines and comments would lose the line number that an error names.
fn read_points(text: &str) -> Result<Vec<Point>, (Option<usize>, TableErrorKind)> {
    // Spreadsheets put a byte order mark before the header.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines =
        (1..).zip(text.lines().map(str::trim)).filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let empty = (None, TableErrorKind::Empty);
    let Some((number, header)) = lines.next() else {
        return Err(empty);
    };
    if !header.split(',').map(str::trim).eq(COLUMNS) {
        return Err((Some(number), TableErrorKind::Header(header.to_owned())));
    }
    let mut points: Vec<Point> = Vec::new();
    for (number, line) in lines {
        let point = read_point(line).map_err(|kind| (Some(number), kind))?;
        if let Some(last) = points.last()
            && point.time_s <= last.time_s
        {
            let kind = TableErrorKind::NotIncreasing { found: point.time_s, before: last.time_s };
            return Err((Some(number), kind));
        }
        points.push(point);
    }
    if points.is_empty() { Err(empty) } else { Ok(points) }
}

fn read_point(line: &str) -> Result<Point, TableErrorKind> {
    let Some((time, position)) = line.split_once(',').filter(|(_, position)| !position.contains(',')) else {
        return Err(TableErrorKind::Fields(line.split(',').count()));
    };
    Ok(Point { time_s: read_number(COLUMNS[0], time)?, position_rad: read_number(COLUMNS[1], position)? })
}

fn read_number(column: &'static str, field: &str) -> Result<f64, TableErrorKind> {
    let field = field.trim();
    match field.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(found) => Err(TableErrorKind::NotFinite { column, found }),
        Err(_) => Err(TableErrorKind::NotANumber { column, found: field.to_owned() }),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Interpolation, Table};

    fn table(text: &str, interpolation: Interpolation) -> Result<Table, String> {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let file = directory.path().join("points.csv");
        std::fs::write(&file, text).expect("a temporary file");
        Table::from_file(&file, interpolation)
            .map_err(|error| error.to_string().replace(&format!("{}/", directory.path().display()), ""))
    }

    const POINTS: &str = "time_s,position_rad\n# a corner\n1,0\n2,1\n4,-1\n";

    #[test]
    fn linear_points_are_joined_by_lines_and_the_ends_hold() {
        let table = table(POINTS, Interpolation::Linear).expect("a good table");
        for (t_s, want) in
            [(0.0, 0.0), (1.0, 0.0), (1.5, 0.5), (2.0, 1.0), (3.5, -0.5), (4.0, -1.0), (9.0, -1.0)]
        {
            assert_eq!(table.position_rad(t_s), want, "at {t_s} s");
        }
    }

    #[test]
    fn held_points_jump_at_their_own_time() {
        let table = table(POINTS, Interpolation::Hold).expect("a good table");
        for (t_s, want) in [(0.0, 0.0), (1.999, 0.0), (2.0, 1.0), (3.999, 1.0), (4.0, -1.0), (9.0, -1.0)] {
            assert_eq!(table.position_rad(t_s), want, "at {t_s} s");
        }
    }

    #[test]
    fn one_point_is_a_constant() {
        let table = table("time_s,position_rad\n0,0.25\n", Interpolation::Linear).expect("a good table");
        assert_eq!([-1.0, 0.0, 1.0].map(|t_s| table.position_rad(t_s)), [0.25; 3]);
    }

    #[test]
    fn every_error_names_file_line_and_reason() {
        let errors: Vec<_> = [
            "time_s,position_rad\n",
            "",
            "t,theta\n0,0\n",
            "time_s,position_rad\n0,0\n# half way\n1,one\n",
            "time_s,position_rad\n0,0\n1,NaN\n",
            "time_s,position_rad\ninf,0\n",
            "time_s,position_rad\n0,0\n0,1\n",
            "time_s,position_rad\n1,0\n0.5,1\n",
            "time_s,position_rad\n\n0,0,0\n",
            "time_s,position_rad\n0;0\n",
        ]
        .into_iter()
        .map(|text| table(text, Interpolation::Linear).expect_err("a bad table"))
        .collect();
        insta::assert_snapshot!(errors.join("\n"), @r#"
        table points.csv: has no points; it must have at least one
        table points.csv: has no points; it must have at least one
        table points.csv:1: the columns are "t,theta"; they must be "time_s,position_rad"
        table points.csv:4: position_rad is "one"; it must be a number
        table points.csv:3: position_rad is NaN; it must be finite
        table points.csv:2: time_s is inf; it must be finite
        table points.csv:3: time_s is 0 after 0; times must increase
        table points.csv:3: time_s is 0.5 after 1; times must increase
        table points.csv:3: fields in this row: 3; a row must have 2
        table points.csv:2: fields in this row: 1; a row must have 2
        "#);
    }

    #[test]
    fn missing_file_is_named() {
        let error = Table::from_file(Path::new("no/such.csv"), Interpolation::Hold).expect_err("no file");
        assert_eq!(
            error.to_string(),
            "table no/such.csv: can't be read: No such file or directory (os error 2)"
        );
    }
}
