//! `runs.csv`: a row per run. A figure that a run does not have is a word that says why.

use std::io::{self, Write};

use super::case::{Case, CaseId};
use super::runs::CaseResult;
use super::score::{Criterion, Score};

/// Writes the table, its rows in the order given. Numbers are the shortest that read back to the same bits.
///
/// # Errors
/// `out` can't take it.
pub fn write<'a>(
    out: impl Write,
    results: impl Iterator<Item = (&'a Case, &'a CaseResult)>,
) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let criteria = Criterion::ALL.map(|criterion| criterion.metric().name());
    let columns = ["part", "row", "controller"].into_iter().chain(criteria);
    table.write_record(columns.chain(["end", "torque_sha256", "set"]))?;
    for (case, result) in results {
        let CaseId { part, row, law } = case.id;
        let place = [part.name().to_owned(), row.to_string(), law.name().to_owned()];
        let criteria = Criterion::ALL.map(|criterion| match result.scores.get(criterion) {
            Score::Value(value) => zmij::Buffer::new().format(value).to_owned(),
            Score::Missing(reason) => reason.to_string(),
        });
        let rest = [result.end.clone(), result.torque_sha256.clone(), case.settings.join(" ")];
        table.write_record(place.into_iter().chain(criteria).chain(rest))?;
    }
    table.flush()
}
