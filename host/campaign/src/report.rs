//! Statistics of a merged table, and the verdict of a campaign. Quantiles are exact; columns are read a few at a time.

use std::collections::BTreeMap;
use std::fmt;

use lashloop_bench::verdict::Verdict;
use lashloop_session::counted;
use serde::Serialize;

use crate::cell::{Cell, Missing};
use crate::error::CampaignError;
use crate::expectation::{Judged, State, shown};
use crate::quantile::Sorted;
use crate::run::NO_RUN;
use crate::settings::{Expectation, Statistic};
use crate::table::{Numbers, Row, Table};

/// Quantiles of a printed table: half of the runs are no worse, 95 % are, all are.
pub const QUANTILES: [(&str, f64); 3] = [("median", 0.5), ("p95", 0.95), ("max", 1.0)];

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    pub title: String,
    pub verdict: Verdict,
    pub seed: u64,
    pub cases: u64,
    /// One for each part and variant.
    pub groups: Vec<Group>,
    pub expectations: Vec<Judged>,
    pub no_run: NoRun,
}

/// Cases without a run, which are INVALID.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct NoRun {
    pub cases: u64,
    /// Why, of the first ones.
    pub first: BTreeMap<u64, String>,
}

/// Reasons in a report at most; the table has all.
const REASONS: u64 = 10;

/// The runs of a variant on the rows of a part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    pub part: String,
    pub variant: String,
    pub runs: u64,
    pub pass: u64,
    pub fail: u64,
    pub invalid: u64,
    /// In the order of the table; without columns that no run has.
    pub columns: Vec<ColumnQuantiles>,
}

/// Quantiles of the magnitude of a column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnQuantiles {
    pub column: String,
    pub median: Cell,
    pub p80: Cell,
    pub p95: Cell,
    pub p99: Cell,
    pub max: Cell,
    /// Runs without a value, by reason.
    pub missing: BTreeMap<&'static str, u64>,
}

/// What else is computed in the passes of a report.
pub trait Observer {
    /// Takes each row once, in the order of cases.
    ///
    /// # Errors
    /// What is wrong with the row.
    fn row(&mut self, group: usize, row: &Row<'_>) -> Result<(), String>;

    /// Takes each column once: its place among the numbers, and its magnitudes by group.
    fn column(&mut self, column: usize, groups: &[Sorted]);
}

impl Report {
    /// The report, with an observer of the table.
    ///
    /// # Errors
    /// The table can't be read, or is not that of its campaign, or the observer rejects a row.
    pub fn observed(table: &Table<'_>, observer: &mut impl Observer) -> Result<Self, CampaignError> {
        let file = &table.campaign.file;
        let mut report = Self {
            title: file.title.clone(),
            verdict: Verdict::Pass,
            seed: file.seed,
            cases: table.campaign.plan.cases(),
            groups: empty_groups(table),
            expectations: Vec::new(),
            no_run: NoRun::default(),
        };
        let mut judged: Vec<Option<Judged>> = vec![None; file.expectations.len()];
        let columns: Vec<_> = (0..table.columns.numbers.len()).collect();
        for (pass, chosen) in columns.chunks(table.columns_per_pass()).enumerate() {
            let numbers = read(table, chosen, |group, row| {
                if pass > 0 {
                    return Ok(());
                }
                report.groups[group].count(row.verdict());
                if let Some(reason) = row.end().strip_prefix(NO_RUN) {
                    report.no_run.push(row.case, reason);
                }
                observer.row(group, row)
            })?;
            for (column, groups) in chosen.iter().zip(numbers) {
                let name = &table.columns.numbers[*column];
                let sorted: Vec<_> = groups
                    .into_iter()
                    .map(|Numbers { values, missing }| Sorted::new(values, missing))
                    .collect();
                observer.column(*column, &sorted);
                for (expectation, judged) in file.expectations.iter().zip(&mut judged) {
                    if matches!(&expectation.what, Statistic::Quantile { column, .. } if column == name) {
                        *judged = judge(expectation, &report.groups, &sorted);
                    }
                }
                for (group, sorted) in report.groups.iter_mut().zip(&sorted) {
                    group.columns.extend(ColumnQuantiles::new(name, sorted));
                }
            }
        }
        for (expectation, judged) in file.expectations.iter().zip(&mut judged) {
            if matches!(expectation.what, Statistic::Pass { .. }) {
                let groups = report.groups.iter().filter(|group| group.is_of(expectation));
                let (passes, runs) =
                    groups.fold((0, 0), |(passes, runs), it| (passes + it.pass, runs + it.runs));
                *judged = Judged::pass(expectation, passes, runs);
            }
        }
        report.expectations = judged.into_iter().flatten().collect();
        if report.expectations.iter().any(|judged| judged.state != State::Met) {
            report.verdict = Verdict::Fail;
        }
        Ok(report)
    }
}

fn empty_groups(table: &Table<'_>) -> Vec<Group> {
    let parts = table.campaign.file.parts.iter();
    let groups = parts.flat_map(|part| {
        table.campaign.variants.iter().map(|variant| Group {
            part: part.name.clone(),
            variant: variant.name.clone(),
            runs: 0,
            pass: 0,
            fail: 0,
            invalid: 0,
            columns: Vec::new(),
        })
    });
    groups.collect()
}

/// The numbers of these columns, for each column those of each group. `see` gets each row too.
fn read(
    table: &Table<'_>,
    columns: &[usize],
    mut see: impl FnMut(usize, &Row<'_>) -> Result<(), String>,
) -> Result<Vec<Vec<Numbers>>, CampaignError> {
    let mut numbers: Vec<_> = columns.iter().map(|_| table.groups()).collect();
    table.for_each(|row| {
        let group = table.group(row.case);
        for (column, numbers) in columns.iter().zip(&mut numbers) {
            let cell = row.cell(*column).ok_or_else(|| {
                format!("{} is neither a number nor a reason", table.columns.numbers[*column])
            })?;
            numbers[group].push(cell);
        }
        see(group, &row)
    })?;
    Ok(numbers)
}

/// Judges a quantile over all groups of the expectation.
fn judge(expectation: &Expectation, groups: &[Group], sorted: &[Sorted]) -> Option<Judged> {
    let mine: Vec<_> =
        groups.iter().zip(sorted).filter(|(group, _)| group.is_of(expectation)).map(|(_, it)| it).collect();
    match mine[..] {
        [only] => Judged::quantile(expectation, only),
        _ => Judged::quantile(expectation, &Sorted::union(&mine)),
    }
}

impl NoRun {
    fn push(&mut self, case: u64, reason: &str) {
        if self.cases < REASONS {
            self.first.insert(case, reason.to_owned());
        }
        self.cases += 1;
    }
}

impl Group {
    fn count(&mut self, verdict: &str) {
        self.runs += 1;
        let count = match verdict {
            "PASS" => &mut self.pass,
            "FAIL" => &mut self.fail,
            _ => &mut self.invalid,
        };
        *count += 1;
    }

    fn is_of(&self, expectation: &Expectation) -> bool {
        expectation.is_of(&self.part, &self.variant)
    }
}

impl ColumnQuantiles {
    /// `None` if no run has the column.
    fn new(column: &str, sorted: &Sorted) -> Option<Self> {
        let at = |quantile| sorted.quantile(quantile);
        let (median, p80, p95, p99, max) = (at(0.5)?, at(0.8)?, at(0.95)?, at(0.99)?, at(1.0)?);
        let missing = sorted.missing();
        // Values rank first, so both ends without one are a column without one.
        let unmeasured = Cell::Missing(Missing::Unmeasured);
        let is_absent = sorted.at_rank(1) == Some(unmeasured) && max == unmeasured;
        (!is_absent).then(|| Self { column: column.to_owned(), median, p80, p95, p99, max, missing })
    }
}

impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "{}: {} runs, seed {}\n", self.title, self.cases, self.seed)?;
        let name = |group: &Group| format!("{}, {}", group.part, group.variant);
        let width = self.groups.iter().map(|group| name(group).len()).max().unwrap_or(0).max(13) + 2;
        writeln!(
            out,
            "{:<32}{:<width$}{:>10}{:>10}{:>10}{:>10}",
            "", "part, variant", "runs", "PASS", "FAIL", "INVALID"
        )?;
        for group in &self.groups {
            let Group { runs, pass, fail, invalid, .. } = group;
            writeln!(out, "{:<32}{:<width$}{runs:>10}{pass:>10}{fail:>10}{invalid:>10}", "", name(group))?;
        }
        if self.no_run.cases > 0 {
            writeln!(out, "\n{} INVALID without a run; the first:", counted(self.no_run.cases, "case"))?;
            self.no_run.first.iter().try_for_each(|(case, why)| writeln!(out, "case {case}: {why}"))?;
        }
        let [median, p95, max] = QUANTILES.map(|(name, _)| name);
        writeln!(
            out,
            "\n{:<32}{:<width$}{median:>12}{p95:>12}{max:>12}{:>10}",
            "magnitude of", "", "missing"
        )?;
        let mut columns: Vec<&str> = Vec::new();
        for column in self.groups.iter().flat_map(|group| &group.columns) {
            if !columns.contains(&column.column.as_str()) {
                columns.push(&column.column);
            }
        }
        for column in columns {
            let mut head = column;
            for group in &self.groups {
                let Some(it) = group.columns.iter().find(|it| it.column == column) else { continue };
                let [median, p95, max] = [it.median, it.p95, it.max].map(shown);
                writeln!(
                    out,
                    "{head:<32}{:<width$}{median:>12}{p95:>12}{max:>12}{:>10}",
                    name(group),
                    it.missing.values().sum::<u64>()
                )?;
                head = "";
            }
        }
        if self.expectations.is_empty() {
            return write!(out, "\nno expectations");
        }
        writeln!(out, "\nexpectations")?;
        self.expectations.iter().try_for_each(|judged| writeln!(out, "{judged}"))?;
        write!(out, "{}", self.verdict)
    }
}
