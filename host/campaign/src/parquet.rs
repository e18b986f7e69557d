//! `results.parquet`: the table with typed columns. A missing number is null, and its reason is in the column `missing`.

use std::fs::File;
use std::io;
use std::path::Path;

use lashloop_record::parquet::{Column, ParquetWriter};

use crate::axis::Values;
use crate::cell::{Cell, Missing};
use crate::error::CampaignError;
use crate::facts::Facts;
use crate::merge::try_write_whole;
use crate::row::{FIRST, LAST};
use crate::settings::MISSING;
use crate::table::{Row, Table};

pub const RESULTS: &str = "results.parquet";

/// Rows that are held at once.
const ROW_GROUP: u64 = 50_000;

/// Writes the table, with the facts of the campaign as metadata of the file.
///
/// # Errors
/// The table can't be read, or the file can't be written.
pub fn write(table: &Table<'_>, facts: &Facts, path: &Path) -> Result<(), CampaignError> {
    try_write_whole(path, ".results-", |file| encode(table, facts, file))
}

fn encode(table: &Table<'_>, facts: &Facts, file: &mut File) -> io::Result<Result<(), CampaignError>> {
    let empty = columns(table);
    let names = empty.iter().map(|(name, column)| (&**name, column));
    let metadata = facts.list().into_iter().map(|(what, value)| (format!("lashloop {what}"), value));
    let mut writer = ParquetWriter::new(file, names, metadata)?;
    let empty: Vec<_> = empty.into_iter().map(|(_, column)| column).collect();
    let (mut group, mut rows) = (empty.clone(), 0);
    let mut failure = None;
    let read = table.for_each(|row| {
        push(table, &mut group, &row);
        rows += 1;
        if rows == ROW_GROUP {
            rows = 0;
            let full = std::mem::replace(&mut group, empty.clone());
            writer.write(full).map_err(|error| {
                let text = error.to_string();
                failure = Some(error);
                text
            })?;
        }
        Ok(())
    });
    if let Some(error) = failure {
        return Err(error);
    }
    if let Err(error) = read {
        return Ok(Err(error));
    }
    if rows > 0 {
        writer.write(group)?;
    }
    writer.finish().map(Ok)
}

/// Names and types of the columns.
fn columns(table: &Table<'_>) -> Vec<(String, Column)> {
    let (whole, text) = (Column::Whole(Vec::new()), Column::Text(Vec::new()));
    let types = [&whole, &text, &whole, &text];
    let first = FIRST.into_iter().zip(types).map(|(name, column)| (name.to_owned(), column.clone()));
    let axes = table.columns.axes.iter().map(|name| {
        let is_number = if is_number(table, name) { Column::Optional(Vec::new()) } else { text.clone() };
        (name.clone(), is_number)
    });
    let numbers = table.columns.numbers.iter().map(|name| (name.clone(), Column::Optional(Vec::new())));
    let last = LAST.into_iter().chain([MISSING]).map(|name| (name.to_owned(), text.clone()));
    first.chain(axes).chain(numbers).chain(last).collect()
}

/// Whether every value of an axis is a number.
fn is_number(table: &Table<'_>, name: &str) -> bool {
    let parts = table.campaign.file.parts.iter();
    parts.flat_map(|part| &part.axes).filter(|axis| axis.name() == name).all(|axis| match &axis.values {
        Values::Range(_) => true,
        Values::Listed(values) => values.iter().all(|value| value.number().is_some()),
    })
}

fn push(table: &Table<'_>, group: &mut [Column], row: &Row<'_>) {
    let last = group.len() - 1;
    for (place, column) in group.iter_mut().enumerate() {
        match column {
            Column::Whole(values) => values.push(row.text(place).parse().unwrap_or_default()),
            Column::Real(values) => values.push(row.text(place).parse().unwrap_or(f64::NAN)),
            Column::Optional(values) => values.push(row.text(place).parse().ok()),
            Column::Text(values) if place == last => values.push(reasons(table, row)),
            Column::Text(values) => values.push(row.text(place).to_owned()),
        }
    }
}

fn reasons(table: &Table<'_>, row: &Row<'_>) -> String {
    let named =
        table.columns.numbers.iter().enumerate().filter_map(|(column, name)| match row.cell(column)? {
            Cell::Missing(Missing::Unmeasured) | Cell::Value(_) => None,
            Cell::Missing(reason) => Some(format!("{name}={reason}")),
        });
    named.collect::<Vec<_>>().join(";")
}
