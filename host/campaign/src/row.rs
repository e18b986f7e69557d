//! A line of the results: the case, its values, its numbers, verdict, end and torque digest.
//!
//! Numbers have the fewest digits that restore the same bits. A line holds no line break, so a whole line is a whole row.

use csv::StringRecord;

use crate::campaign::Campaign;
use crate::cell::Cell;
use crate::plan::Case;
pub use crate::settings::{FIRST, LAST, TORQUE_DIGEST};

/// What a run leaves in the table.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseResult {
    pub cells: Vec<Cell>,
    /// PASS, FAIL or INVALID.
    pub verdict: String,
    pub end: String,
    /// Digest of the torque stream, see [`TorqueDigest`](lashloop_bench::run::digest::TorqueDigest).
    pub torque_sha256: String,
}

/// The columns of a campaign's table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Columns {
    /// Axes of all parts, each once.
    pub axes: Vec<String>,
    /// Metrics and derived columns.
    pub numbers: Vec<String>,
    /// For each part the place of its axes in `axes`.
    places: Vec<Vec<usize>>,
}

impl Columns {
    #[must_use]
    pub fn of(campaign: &Campaign) -> Self {
        let mut axes: Vec<String> = Vec::new();
        let mut places = Vec::new();
        for part in &campaign.file.parts {
            let place = |axis: &crate::axis::Axis| {
                let known = axes.iter().position(|name| name == axis.name());
                known.unwrap_or_else(|| {
                    axes.push(axis.name().to_owned());
                    axes.len() - 1
                })
            };
            places.push(part.axes.iter().map(place).collect());
        }
        Self { axes, numbers: campaign.file.number_columns(), places }
    }

    /// The first line of a table.
    #[must_use]
    pub fn header(&self) -> Vec<u8> {
        let mut line = Vec::new();
        self.names().for_each(|name| push(&mut line, name));
        end(&mut line);
        line
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        let numbers = self.axes.iter().chain(&self.numbers).map(String::as_str);
        FIRST.into_iter().chain(numbers).chain(LAST)
    }

    /// Name of the column at a place of the line.
    #[must_use]
    pub fn name(&self, place: usize) -> &str {
        self.names().nth(place).unwrap_or_default()
    }

    /// The fields of a case's line.
    #[must_use]
    pub fn fields(&self, campaign: &Campaign, case: &Case, result: &CaseResult) -> StringRecord {
        let mut line = Vec::new();
        self.write(campaign, case, result, &mut line);
        let mut fields = StringRecord::new();
        // Reading from memory fails on bytes that aren't UTF-8, and the line consists of texts.
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(&line[..]);
        let _ = reader.read_record(&mut fields);
        fields
    }

    /// Place of the first number in a line.
    #[must_use]
    pub fn first_number(&self) -> usize {
        FIRST.len() + self.axes.len()
    }

    /// Number of columns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.first_number() + self.numbers.len() + LAST.len()
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends the line of a case.
    pub fn write(&self, campaign: &Campaign, case: &Case, result: &CaseResult, line: &mut Vec<u8>) {
        push(line, &case.number.to_string());
        push(line, &campaign.file.parts[case.part].name);
        push(line, &case.row.to_string());
        push(line, &campaign.variants[case.variant].name);
        let places = &self.places[case.part];
        for axis in 0..self.axes.len() {
            match places.iter().position(|place| *place == axis) {
                Some(value) => push(line, &case.values[value].to_string()),
                None => push(line, ""),
            }
        }
        let mut digits = zmij::Buffer::new();
        for cell in &result.cells {
            match cell {
                Cell::Value(value) => push(line, digits.format(*value)),
                Cell::Missing(reason) => push(line, reason.word()),
            }
        }
        push(line, &result.verdict);
        push(line, &result.end);
        push(line, &result.torque_sha256);
        end(line);
    }
}

/// Appends a field and a comma, in the quotes of RFC 4180 where it needs them.
fn push(line: &mut Vec<u8>, text: &str) {
    if text.contains([',', '"', '\n', '\r']) {
        line.push(b'"');
        for byte in text.bytes() {
            match byte {
                b'"' => line.extend(b"\"\""),
                b'\n' | b'\r' => line.push(b' '),
                byte => line.push(byte),
            }
        }
        line.push(b'"');
    } else {
        line.extend(text.as_bytes());
    }
    line.push(b',');
}

/// Replaces the last comma by the end of the line.
fn end(line: &mut Vec<u8>) {
    line.pop();
    line.push(b'\n');
}

/// Number of the case of a line; `None` unless it is a whole row of this number of fields.
#[must_use]
pub fn case_of(line: &[u8], fields: usize) -> Option<u64> {
    let text = line.strip_suffix(b"\n")?;
    let digest = text.rsplit(|byte| *byte == b',').next()?;
    let is_whole =
        count_fields(text) == fields && digest.len() == 64 && digest.iter().all(u8::is_ascii_hexdigit);
    let end = text.iter().position(|byte| *byte == b',')?;
    is_whole.then(|| std::str::from_utf8(&text[..end]).ok()?.parse().ok()).flatten()
}

/// Fields of a line; a comma in quotes separates none.
#[must_use]
pub fn count_fields(line: &[u8]) -> usize {
    let mut is_quoted = false;
    let separates = |byte: &&u8| {
        is_quoted ^= **byte == b'"';
        **byte == b',' && !is_quoted
    };
    line.iter().filter(separates).count() + 1
}
