//! A reference given by points, from a CSV file with the columns `time_s,position_rad`.
//!
//! Times increase strictly. Before the first point the first position holds, after the last the last. Lines
//! that start with `#` are comments.

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// What lies between two points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// A straight line.
    Linear,
    /// The earlier position.
    Hold,
}

/// A reference given by points; at least one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    /// Where the points come from.
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

/// A table that can't be used: which file, which line, why.
#[derive(Debug, thiserror::Error)]
#[error("table {}{}: {fault}", file.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct TableError {
    /// The file as it was opened.
    pub file: PathBuf,
    /// Counted from 1; `None` if the whole file is at fault.
    pub line: Option<usize>,
    /// What is wrong.
    pub fault: TableFault,
}

/// What can be wrong with a table.
#[derive(Debug, thiserror::Error)]
pub enum TableFault {
    /// The file can't be read.
    #[error("cannot be read: {0}")]
    Read(#[source] io::Error),
    /// The first line isn't the header.
    #[error("the columns are {0:?}; they must be \"time_s,position_rad\"")]
    Header(String),
    /// A line with more or fewer than two fields.
    #[error("fields in this row: {0}; a row must have 2")]
    Fields(usize),
    /// A field that isn't a number.
    #[error("{column} is {found:?}; it must be a number")]
    NotANumber {
        /// The column.
        column: &'static str,
        /// The field.
        found: String,
    },
    /// NaN or infinite.
    #[error("{column} is {found}; it must be finite")]
    NotFinite {
        /// The column.
        column: &'static str,
        /// The value.
        found: f64,
    },
    /// A time that isn't later than the one before.
    #[error("time_s is {found} after {before}; times must increase")]
    NotIncreasing {
        /// This line's time.
        found: f64,
        /// The time of the line before.
        before: f64,
    },
    /// No points.
    #[error("has no points; it must have at least one")]
    Empty,
}

const COLUMNS: [&str; 2] = ["time_s", "position_rad"];

impl Table {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// The file can't be read, its columns have other names, or a line has something else than a finite time
    /// after the one before and a finite position.
    pub fn from_file(file: &Path, interpolation: Interpolation) -> Result<Self, TableError> {
        let error = |fault| TableError { file: file.to_owned(), line: None, fault };
        let text = std::fs::read_to_string(file).map_err(|source| error(TableFault::Read(source)))?;
        let points =
            read_points(&text).map_err(|(line, fault)| TableError { file: file.to_owned(), line, fault })?;
        Ok(Self { file: file.to_owned(), interpolation, points })
    }

    /// The position asked for at a time of the run, in rad.
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
                let share = (t_s - previous.time_s) / (next.time_s - previous.time_s);
                previous.position_rad + share * (next.position_rad - previous.position_rad)
            }
        }
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

/// Line by line rather than with a CSV reader: two columns of numbers need no quoting, and a reader that skips
/// blank lines and comments loses count of the lines a fault has to name.
fn read_points(text: &str) -> Result<Vec<Point>, (Option<usize>, TableFault)> {
    // Spreadsheets put a byte order mark before the header.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines =
        (1..).zip(text.lines().map(str::trim)).filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let empty = (None, TableFault::Empty);
    let Some((number, header)) = lines.next() else {
        return Err(empty);
    };
    if !header.split(',').map(str::trim).eq(COLUMNS) {
        return Err((Some(number), TableFault::Header(header.to_owned())));
    }
    let mut points: Vec<Point> = Vec::new();
    for (number, line) in lines {
        let point = read_point(line).map_err(|fault| (Some(number), fault))?;
        if let Some(last) = points.last()
            && point.time_s <= last.time_s
        {
            let fault = TableFault::NotIncreasing { found: point.time_s, before: last.time_s };
            return Err((Some(number), fault));
        }
        points.push(point);
    }
    if points.is_empty() { Err(empty) } else { Ok(points) }
}

fn read_point(line: &str) -> Result<Point, TableFault> {
    let Some((time, position)) = line.split_once(',').filter(|(_, position)| !position.contains(',')) else {
        return Err(TableFault::Fields(line.split(',').count()));
    };
    Ok(Point { time_s: read_number(COLUMNS[0], time)?, position_rad: read_number(COLUMNS[1], position)? })
}

fn read_number(column: &'static str, field: &str) -> Result<f64, TableFault> {
    let field = field.trim();
    match field.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(found) => Err(TableFault::NotFinite { column, found }),
        Err(_) => Err(TableFault::NotANumber { column, found: field.to_owned() }),
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
    fn lines_are_drawn_between_points_and_the_ends_hold() {
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
    fn every_fault_names_file_line_and_reason() {
        let faults: Vec<_> = [
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
        .map(|text| table(text, Interpolation::Linear).expect_err("a faulty table"))
        .collect();
        insta::assert_snapshot!(faults.join("\n"), @r#"
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
    fn an_absent_file_is_named() {
        let error = Table::from_file(Path::new("no/such.csv"), Interpolation::Hold).expect_err("no file");
        assert_eq!(
            error.to_string(),
            "table no/such.csv: cannot be read: No such file or directory (os error 2)"
        );
    }
}
