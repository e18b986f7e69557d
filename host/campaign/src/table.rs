//! The merged table, read back row by row and column by column.

use std::path::{Path, PathBuf};

use csv::StringRecord;

use crate::campaign::Campaign;
use crate::cell::{Cell, Missing};
use crate::error::CampaignError;
use crate::row::{Columns, LAST};

/// Bytes of numbers that one pass over the table collects.
const BUDGET: u64 = 1 << 27;

/// The table of a campaign.
#[derive(Debug)]
pub struct Table<'a> {
    pub campaign: &'a Campaign,
    pub columns: Columns,
    path: PathBuf,
}

/// A row while it is read.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    pub case: u64,
    columns: &'a Columns,
    fields: &'a StringRecord,
}

/// The numbers of a column over the runs of one part and variant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Numbers {
    pub values: Vec<f64>,
    /// By [`Missing::ALL`].
    pub missing: [u64; Missing::ALL.len()],
}

impl Row<'_> {
    /// The number of a column, by its place among the numbers.
    #[must_use]
    pub fn cell(&self, column: usize) -> Option<Cell> {
        Cell::parse(self.text(self.columns.first_number() + column))
    }

    #[must_use]
    pub fn verdict(&self) -> &str {
        self.text(self.columns.len() - LAST.len())
    }

    #[must_use]
    pub fn end(&self) -> &str {
        self.text(self.columns.len() - LAST.len() + 1)
    }

    #[must_use]
    pub fn torque_sha256(&self) -> &str {
        self.text(self.columns.len() - 1)
    }

    #[must_use]
    pub const fn fields(&self) -> &StringRecord {
        self.fields
    }

    /// A field by its place in the line.
    #[must_use]
    pub fn text(&self, column: usize) -> &str {
        self.fields.get(column).unwrap_or_default()
    }
}

impl<'a> Table<'a> {
    #[must_use]
    pub fn new(campaign: &'a Campaign, path: &Path) -> Self {
        Self { campaign, columns: Columns::of(campaign), path: path.to_owned() }
    }

    /// Passes every row to `take`, in the order of cases.
    ///
    /// # Errors
    /// The table can't be read, is not that of the campaign, or `take` refuses a row with the reason.
    pub fn for_each(&self, mut take: impl FnMut(Row<'_>) -> Result<(), String>) -> Result<(), CampaignError> {
        let malformed = |line, problem| CampaignError::Table { path: self.path.clone(), line, problem };
        let reader =
            csv::ReaderBuilder::new().has_headers(false).buffer_capacity(1 << 16).from_path(&self.path);
        let mut reader = reader.map_err(|error| malformed(1, error.to_string()))?;
        let mut fields = StringRecord::new();
        let mut line = 0;
        let mut is_there = |fields: &mut StringRecord| {
            line += 1;
            let read = reader.read_record(fields).map_err(|error| malformed(line, error.to_string()));
            read.map(|is_there| (line, is_there))
        };
        is_there(&mut fields)?;
        let header = self.columns.header();
        if !fields.iter().eq(String::from_utf8_lossy(&header).trim_end().split(',')) {
            return Err(malformed(1, "the columns are not those of the campaign".to_owned()));
        }
        for case in 0..self.campaign.plan.cases() {
            let (line, is_there) = is_there(&mut fields)?;
            if !is_there || fields.get(0).and_then(|number| number.parse().ok()) != Some(case) {
                return Err(malformed(line, format!("expected case {case}")));
            }
            take(Row { case, columns: &self.columns, fields: &fields })
                .map_err(|problem| malformed(line, problem))?;
        }
        Ok(())
    }

    /// How many columns one pass can collect within a bounded memory.
    #[must_use]
    pub fn columns_per_pass(&self) -> usize {
        (BUDGET / (self.campaign.plan.cases().max(1) * 8)).clamp(1, 1000) as usize
    }

    /// Numbers of empty columns for each part and variant, with space for their runs.
    #[must_use]
    pub fn groups(&self) -> Vec<Numbers> {
        let variants = self.campaign.variants.len();
        let parts = 0..self.campaign.file.parts.len();
        let rows = parts.flat_map(|part| std::iter::repeat_n(self.campaign.plan.rows(part), variants));
        rows.map(|rows| Numbers { values: Vec::with_capacity(rows as usize), ..Numbers::default() }).collect()
    }

    /// Place of a case among the [`groups`](Self::groups).
    #[must_use]
    pub fn group(&self, case: u64) -> usize {
        let (part, _, variant) = self.campaign.plan.place(case);
        part * self.campaign.variants.len() + variant
    }
}

impl Numbers {
    pub fn push(&mut self, cell: Cell) {
        match cell {
            Cell::Value(value) => self.values.push(value),
            Cell::Missing(reason) => self.missing[reason as usize] += 1,
        }
    }
}
