//! The tables of a battery, for readers and for programs.

use std::fmt;

use serde::Serialize;

use super::limits::{self, Finding, LIMITS};
use super::plan::{Law, Part, Settings};
use super::runs::CaseResult;
use super::score::{Figure, Lack, Score, Scores};
use super::spread::{Quantile, Spread};
use super::sweeps::{SWEEPS, Sweep};
use crate::run::End;
use crate::verdict::Verdict;

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
            never_settled: without(Lack::Never),
            cut_short: without(Lack::CutShort),
            not_finite: without(Lack::NotFinite),
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
            "runs that", "never settle", "are cut off", "not finite"
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
mod tests {
    use super::*;
    use crate::battery::plan::CaseId;

    fn result(part: Part, row: u32, law: Law, settle_time: &str, end: &str) -> CaseResult {
        let other = if settle_time.starts_with('"') { settle_time } else { "-0.001" };
        let scores = format!(
            r#"{{"settle_time_s":{settle_time},"static_error_rad":{other},"hunting_rad":{other},
            "dead_zone_error_rad":{other},"effort_nm2s":{other},"torque_total_variation_nm":{other}}}"#
        );
        CaseResult {
            case: CaseId { part, row, law },
            end: end.to_owned(),
            scores: serde_json::from_str(&scores).expect("scores"),
            torque_sha256: String::new(),
        }
    }

    /// Twenty plants, of which so many diverge.
    fn report(diverged: u32) -> Report {
        let settings = Settings { seed: 1, plants: 20, laws: vec![Law::Pd, Law::Compensating], sweeps: true };
        let mut results = Vec::new();
        for row in 0..20 {
            results.push(result(Part::RandomPlants, row, Law::Pd, "\"never\"", "complete"));
            let (time, end) =
                if row < diverged { ("\"not finite\"", "it blew up") } else { ("2.5", "complete") };
            results.push(result(Part::RandomPlants, row, Law::Compensating, time, end));
        }
        results.push(result(Part::TorqueDelay, 5, Law::Pd, "\"cut short\"", "the drive latched it"));
        Report::new(&settings, results.iter())
    }

    #[test]
    fn one_run_that_diverges_fails_the_battery_and_is_in_the_tables() {
        assert_eq!(report(0).verdict, Verdict::Pass);
        let report = report(1);
        assert_eq!(report.verdict, Verdict::Fail);
        let met: Vec<_> = report.limits.iter().map(|finding| finding.met).collect();
        assert_eq!(met, [true, false, false, true], "the 19th of 20 is the 95 % quantile");
        insta::assert_snapshot!(report);
    }

    #[test]
    fn without_the_law_that_has_limits_nothing_is_judged_and_that_is_said() {
        let settings = Settings { seed: 1, plants: 1, laws: vec![Law::Pd], sweeps: false };
        let results = [result(Part::RandomPlants, 0, Law::Pd, "\"never\"", "complete")];
        let report = Report::new(&settings, results.iter());
        assert!(report.limits.is_empty());
        assert!(report.to_string().ends_with("no limits: they are those of compensating"), "{report}");
    }
}
