//! The tables of a battery, for readers and for programs.

use std::fmt;

use serde::Serialize;

use super::limits::{self, Finding, LIMITS};
use super::plan::{Law, Part, Settings};
use super::quantiles::{Quantile, Spread};
use super::runs::CaseResult;
use super::score::{Figure, MissingReason, Score, Scores};
use super::sweeps::{SWEEPS, Sweep};
use lashloop_bench::run::End;
use lashloop_bench::verdict::Verdict;

/// Everything that a complete battery says.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Whether the limits are met.
    pub verdict: Verdict,
    /// What the battery was made of.
    pub settings: Settings,
    /// The laws on the random plants.
    pub random_plants: Vec<LawReport>,
    /// The limits; empty without the law that they are for.
    pub limits: Vec<Finding>,
    /// The laws on the nominal plant with one thing varied.
    pub sweeps: Vec<SweepReport>,
}

/// One law on the random plants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawReport {
    law: Law,
    runs: usize,
    /// Runs whose load never stayed in the band.
    never_settled: usize,
    /// Runs that did not reach their end.
    cut_short: usize,
    /// Runs that left the finite numbers or whose plant could not be followed.
    not_finite: usize,
    /// In the order of [`Figure::ALL`].
    spreads: Vec<FigureSpread>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct FigureSpread {
    figure: Figure,
    #[serde(flatten)]
    spread: Spread,
}

/// One sweep.
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
    /// The report on the results of all runs.
    #[must_use]
    pub fn new<'a>(settings: &Settings, results: impl Iterator<Item = &'a CaseResult> + Clone) -> Self {
        let random_plants: Vec<_> =
            settings.laws.iter().filter_map(|&law| LawReport::new(law, results.clone())).collect();
        let judged = random_plants.iter().filter(|report| report.law == limits::LAW);
        let limits: Vec<_> = judged
            .flat_map(|report| {
                LIMITS.iter().filter_map(|limit| Some(limit.judge(report.spread(limit.figure)?)))
            })
            .collect();
        let verdict = if limits.iter().all(|finding| finding.met) { Verdict::Pass } else { Verdict::Fail };
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
    /// `None` if the law has not been run.
    fn new<'a>(law: Law, results: impl Iterator<Item = &'a CaseResult>) -> Option<Self> {
        let mine: Vec<_> = results
            .filter(|result| result.case.part == Part::RandomPlants && result.case.law == law)
            .map(|result| result.scores)
            .collect();
        let spreads = Figure::ALL.map(|figure| {
            let spread = Spread::of(mine.iter().map(|scores| scores.get(figure)))?;
            Some(FigureSpread { figure, spread })
        });
        let without = |lack| {
            let settled = mine.iter().map(|scores| scores.get(Figure::SettleTime));
            settled.filter(|score| *score == Score::Without(lack)).count()
        };
        Some(Self {
            law,
            runs: mine.len(),
            never_settled: without(MissingReason::Never),
            cut_short: without(MissingReason::CutShort),
            not_finite: without(MissingReason::NotFinite),
            spreads: spreads.into_iter().collect::<Option<_>>()?,
        })
    }

    fn spread(&self, figure: Figure) -> Option<&Spread> {
        self.spreads.iter().find(|it| it.figure == figure).map(|it| &it.spread)
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

/// The size of a figure, or why there is none.
fn cell(figure: Figure, score: Score) -> String {
    match score.size() {
        Score::Value(size) => figure.show(size),
        Score::Without(lack) => lack.to_string(),
    }
}

fn heading(figure: Figure) -> String {
    format!("{}, {}", figure.name(), figure.unit())
}

impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Settings { seed, plants, .. } = self.settings;
        let [median, p95, max] = Quantile::ALL.map(Quantile::name);
        writeln!(
            out,
            "{:<40}{median:>12}{p95:>12}{max:>12}",
            format!("{plants} random plants, seed {seed}")
        )?;
        for figure in Figure::ALL {
            let mut name = heading(figure);
            for report in &self.random_plants {
                let Some(spread) = report.spread(figure) else { continue };
                let [median, p95, max] = Quantile::ALL.map(|quantile| cell(figure, spread.get(quantile)));
                writeln!(out, "{name:<26}{:<14}{median:>12}{p95:>12}{max:>12}", report.law)?;
                name.clear();
            }
        }
        writeln!(
            out,
            "\n{:<40}{:>12}{:>12}{:>12}",
            "runs without a settle time", "never", "cut short", "not finite"
        )?;
        for LawReport { law, runs, never_settled, cut_short, not_finite, .. } in &self.random_plants {
            let of = format!("of {runs}");
            writeln!(out, "{of:<26}{law:<14}{never_settled:>12}{cut_short:>12}{not_finite:>12}")?;
        }
        for sweep in &self.sweeps {
            writeln!(out, "\n{sweep}")?;
        }
        if self.limits.is_empty() {
            return write!(out, "\nno limits: they are those of {}", limits::LAW);
        }
        writeln!(out, "\nlimits of {} on the random plants", limits::LAW)?;
        self.limits.iter().try_for_each(|finding| writeln!(out, "{finding}"))?;
        write!(out, "{}", self.verdict)
    }
}

impl fmt::Display for SweepReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, unit, rows, .. } = self;
        write!(out, "{:<18}{:<14}", format!("{name}, {unit}"), "")?;
        for figure in Figure::ALL {
            write!(out, "{:>14}", figure.name())?;
        }
        write!(out, "\n{:<32}", "")?;
        for figure in Figure::ALL {
            write!(out, "{:>14}", figure.unit())?;
        }
        let mut last = None;
        for SweepRow { value, law, scores, .. } in rows {
            let value = Some(*value).filter(|_| last.replace(*value) != Some(*value));
            write!(out, "\n{:<18}{law:<14}", value.map_or_else(String::new, |value| value.to_string()))?;
            for figure in Figure::ALL {
                write!(out, "{:>14}", cell(figure, scores.get(figure)))?;
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
