//! The results as text.

use std::fmt::{self, Write};

use lashloop_session::counted;

use super::case_result::{CaseResult, Status};
use super::tally::Tally;

/// Longest name that widens the column of names.
const WIDEST: usize = 72;

/// A case on one line.
#[must_use]
pub fn line(result: &CaseResult, name_width: usize) -> String {
    let CaseResult { case, status, checks, wall_s, .. } = result;
    let met = checks.iter().filter(|check| check.ok).count();
    let checks = match (status, checks.len()) {
        (Status::Skipped | Status::BadScenario | Status::DeviceOrLink, _) => String::new(),
        (_, 0) => "none expected".to_owned(),
        (_, all) => format!("{met} of {all} met"),
    };
    format!("{:<7}  {case:<name_width$}  {checks:<14}  {wall_s:>8.2} s", status.word())
}

/// Width of the column of names.
#[must_use]
pub fn name_width(tally: &Tally<'_>) -> usize {
    tally.cases.iter().map(|case| case.name.chars().count()).max().unwrap_or(0).min(WIDEST)
}

/// The table with the reasons of each case that did not pass, and the sum as the last line.
pub struct Table<'a> {
    pub tally: &'a Tally<'a>,
    pub wall_s: f64,
}

impl fmt::Display for Table<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = name_width(self.tally);
        for (_, result) in self.tally.rows() {
            writeln!(out, "{}", line(result, width))?;
            for reason in &result.reasons {
                writeln!(out, "         {reason}")?;
            }
            if let Some(record) = result.record.as_ref().filter(|_| result.status != Status::Pass) {
                writeln!(out, "         record: {}", record.display())?;
            }
        }
        let mut words: Vec<_> = Status::ALL.iter().map(|status| status.word()).collect();
        words.dedup();
        let mut counts = String::new();
        for word in words {
            write!(counts, ", {} {word}", self.tally.count(word))?;
        }
        let missing = self.tally.cases.len() - self.tally.done();
        if missing > 0 {
            write!(counts, ", {missing} not run")?;
        }
        let all = counted(self.tally.cases.len() as u64, "case");
        write!(out, "{all}: {}; {:.1} s", &counts[2..], self.wall_s)
    }
}
