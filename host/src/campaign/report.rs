//! The report of a campaign, as text and as JSON.

use std::fmt;

use serde::Serialize;

use super::case::{CaseResult, Part};
use super::law::Law;
use super::limits::{LIMITS, LimitResult};
use super::plan::Settings;
use super::quantiles::{Quantile, Quantiles};
use super::score::{Criterion, MissingReason, Score, Scores};
use super::sweeps::{SWEEPS, Sweep};
use lashloop_bench::run::End;
use lashloop_bench::verdict::Verdict;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    pub verdict: Verdict,
    pub settings: Settings,
    pub random_plants: Vec<LawReport>,
    /// Empty without a law that has limits.
    pub limits: Vec<LimitResult>,
    pub sweeps: Vec<SweepReport>,
}

/// One law on the random plants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawReport {
    law: Law,
    runs: usize,
    never_settled: usize,
    cut_short: usize,
    not_finite: usize,
    /// In the order of [`Criterion::ALL`].
    #[serde(rename = "spreads")]
    quantiles: Vec<CriterionQuantiles>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct CriterionQuantiles {
    #[serde(rename = "figure")]
    criterion: Criterion,
    #[serde(flatten)]
    quantiles: Quantiles,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepReport {
    part: Part,
    name: &'static str,
    unit: &'static str,
    rows: Vec<SweepRow>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct SweepRow {
    value: f64,
    law: Law,
    end: String,
    scores: Scores,
}

impl Report {
    #[must_use]
    pub fn new<'a>(settings: &Settings, results: impl Iterator<Item = &'a CaseResult> + Clone) -> Self {
        let random_plants: Vec<_> =
            settings.laws.iter().filter_map(|&law| LawReport::new(law, results.clone())).collect();
        let limits: Vec<_> = random_plants
            .iter()
            .flat_map(|report| {
                let mine = LIMITS.iter().filter(|limit| limit.law == report.law);
                mine.filter_map(|limit| Some(limit.judge(report.quantiles(limit.criterion)?)))
            })
            .collect();
        let verdict = if limits.iter().all(|result| result.met) { Verdict::Pass } else { Verdict::Fail };
        let sweeps = SWEEPS.iter().map(|sweep| SweepReport::new(sweep, results.clone()));
        Self {
            verdict,
            settings: settings.clone(),
            random_plants,
            limits,
            sweeps: sweeps.filter(|sweep| !sweep.rows.is_empty()).collect(),
        }
    }
}

impl LawReport {
    /// `None` without a run of the law.
    fn new<'a>(law: Law, results: impl Iterator<Item = &'a CaseResult>) -> Option<Self> {
        let mine: Vec<_> = results
            .filter(|result| result.case.part == Part::RandomPlants && result.case.law == law)
            .map(|result| result.scores)
            .collect();
        let quantiles = Criterion::ALL.map(|criterion| {
            let quantiles = Quantiles::of(mine.iter().map(|scores| scores.get(criterion)))?;
            Some(CriterionQuantiles { criterion, quantiles })
        });
        let without = |reason| {
            let settled = mine.iter().map(|scores| scores.get(Criterion::SettleTime));
            settled.filter(|score| *score == Score::Missing(reason)).count()
        };
        Some(Self {
            law,
            runs: mine.len(),
            never_settled: without(MissingReason::Never),
            cut_short: without(MissingReason::CutShort),
            not_finite: without(MissingReason::NotFinite),
            quantiles: quantiles.into_iter().collect::<Option<_>>()?,
        })
    }

    fn quantiles(&self, criterion: Criterion) -> Option<&Quantiles> {
        self.quantiles.iter().find(|it| it.criterion == criterion).map(|it| &it.quantiles)
    }
}

impl SweepReport {
    fn new<'a>(sweep: &Sweep, results: impl Iterator<Item = &'a CaseResult>) -> Self {
        let mine = results.filter(|result| result.case.part == sweep.part);
        let rows = mine.filter_map(|result| {
            Some(SweepRow {
                value: *sweep.values.get(result.case.row as usize)?,
                law: result.case.law,
                end: result.end.clone(),
                scores: result.scores,
            })
        });
        Self { part: sweep.part, name: sweep.name, unit: sweep.unit, rows: rows.collect() }
    }
}

fn heading(criterion: Criterion) -> String {
    format!("{}, {}", criterion.name(), criterion.unit())
}

/// A line of a table with three columns. Its head has space for the longest name of a law.
fn row(out: &mut fmt::Formatter<'_>, head: &str, [one, two, three]: [impl fmt::Display; 3]) -> fmt::Result {
    writeln!(out, "{head:<42}{one:>12}{two:>12}{three:>12}")
}

impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Settings { seed, plants, .. } = self.settings;
        row(out, &format!("{plants} random plants, seed {seed}"), Quantile::SHOWN)?;
        for criterion in Criterion::ALL {
            let mut name = heading(criterion);
            for report in &self.random_plants {
                let Some(quantiles) = report.quantiles(criterion) else { continue };
                if quantiles.get(Quantile::Median) == Score::Missing(MissingReason::Unmeasured) {
                    continue;
                }
                let cells = Quantile::SHOWN.map(|quantile| criterion.cell(quantiles.get(quantile)));
                row(out, &format!("{name:<26}{}", report.law), cells)?;
                name.clear();
            }
        }
        writeln!(out)?;
        row(out, "runs without a settle time", ["never", "cut short", "not finite"])?;
        for LawReport { law, runs, never_settled, cut_short, not_finite, .. } in &self.random_plants {
            let of = format!("of {runs}");
            row(out, &format!("{of:<26}{law}"), [never_settled, cut_short, not_finite])?;
        }
        for sweep in &self.sweeps {
            writeln!(out, "\n{sweep}")?;
        }
        if self.limits.is_empty() {
            return write!(out, "\nno limits: none of these laws has any");
        }
        for mine in self.limits.chunk_by(|one, next| one.limit.law == next.limit.law) {
            writeln!(out, "\nlimits of {} on the random plants", mine[0].limit.law)?;
            mine.iter().try_for_each(|result| writeln!(out, "{result}"))?;
        }
        write!(out, "{}", self.verdict)
    }
}

impl fmt::Display for SweepReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, unit, rows, .. } = self;
        write!(out, "{:<34}", format!("{name}, {unit}"))?;
        for criterion in Criterion::SWEPT {
            write!(out, "{:>13}", criterion.name())?;
        }
        write!(out, "\n{:<34}", "")?;
        for criterion in Criterion::SWEPT {
            write!(out, "{:>13}", criterion.unit())?;
        }
        let mut last = None;
        for SweepRow { value, law, scores, .. } in rows {
            let value = Some(*value).filter(|_| last.replace(*value) != Some(*value));
            write!(out, "\n{:<18}{law:<16}", value.map_or_else(String::new, |value| value.to_string()))?;
            for criterion in Criterion::SWEPT {
                write!(out, "{:>13}", criterion.cell(scores.get(criterion)))?;
            }
        }
        for SweepRow { value, law, end, .. } in rows.iter().filter(|row| row.end != End::Complete.to_string())
        {
            write!(out, "\n{law} at {value} {unit}: {end}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
