//! `[[expect]]` judged: a statistic over runs, its interval, and its limit.

use std::fmt;

use lashloop_bench::number::{Apart, Shown};
use serde::Serialize;

use crate::cell::Cell;
use crate::interval;
use crate::quantile::Sorted;
use crate::settings::{Expectation, Judge, Limit, Statistic};

/// What became of an expectation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    Met,
    Missed,
    /// The interval holds the limit.
    NotShown,
}

/// A judged expectation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    pub part: Option<String>,
    pub variant: Option<String>,
    /// Metric or derived column; `pass` for the fraction of runs that pass.
    pub column: String,
    pub quantile: Option<f64>,
    /// Runs that count.
    pub runs: u64,
    pub value: Cell,
    pub confidence: Option<f64>,
    /// `null` where the runs are too few for a bound.
    pub interval: Option<[Option<Cell>; 2]>,
    /// Largest value; `None` if [`below`](Self::below) or [`min`](Self::min) is the limit.
    pub max: Option<f64>,
    pub below: Option<f64>,
    /// Smallest fraction of runs that pass.
    pub min: Option<f64>,
    pub state: State,
}

impl Judged {
    /// Judges a quantile; `None` without a run.
    #[must_use]
    pub fn quantile(expectation: &Expectation, sorted: &Sorted) -> Option<Self> {
        let Statistic::Quantile { column, quantile, limit } = &expectation.what else { return None };
        let value = sorted.quantile(*quantile)?;
        let interval = expectation.confidence.map(|confidence| {
            let ranks = interval::quantile_ranks(*quantile, sorted.len(), confidence);
            ranks.map(|rank| sorted.at_rank(rank?))
        });
        let [lower, upper] = interval.unwrap_or_default();
        let state = judge(
            expectation.judge,
            limit.is_met(value),
            upper.is_some_and(|upper| limit.is_met(upper)),
            lower.is_some_and(|lower| !limit.is_met(lower)),
        );
        let (max, below) = match *limit {
            Limit::Max(max) => (Some(max), None),
            Limit::Below(below) => (None, Some(below)),
        };
        Some(Self {
            part: expectation.part.clone(),
            variant: expectation.variant.clone(),
            column: column.clone(),
            quantile: Some(*quantile),
            runs: sorted.len(),
            value,
            confidence: expectation.confidence,
            interval,
            max,
            below,
            min: None,
            state,
        })
    }

    /// Judges a fraction of passes; `None` for an expectation of another kind or without a run.
    #[must_use]
    pub fn pass(expectation: &Expectation, passes: u64, runs: u64) -> Option<Self> {
        let Statistic::Pass { least } = expectation.what else { return None };
        if runs == 0 {
            return None;
        }
        let value = passes as f64 / runs as f64;
        let interval = expectation.confidence.map(|confidence| interval::fraction(passes, runs, confidence));
        let [lower, upper] = interval.unwrap_or([value; 2]);
        Some(Self {
            part: expectation.part.clone(),
            variant: expectation.variant.clone(),
            column: "pass".to_owned(),
            quantile: None,
            runs,
            value: Cell::Value(value),
            confidence: expectation.confidence,
            interval: interval.map(|bounds| bounds.map(|bound| Some(Cell::Value(bound)))),
            max: None,
            below: None,
            min: Some(least),
            state: judge(expectation.judge, value >= least, lower >= least, upper < least),
        })
    }
}

/// By the value, or by the whole interval if the limit has to be shown.
const fn judge(by: Judge, value: bool, interval_meets: bool, interval_misses: bool) -> State {
    match (by, interval_meets, interval_misses) {
        (Judge::Interval, true, _) => State::Met,
        (Judge::Interval, false, false) => State::NotShown,
        (Judge::Interval, false, true) => State::Missed,
        (Judge::Value, ..) if value => State::Met,
        (Judge::Value, ..) => State::Missed,
    }
}

/// A number with the digits that a reader needs, or the reason for its absence.
#[must_use]
pub fn shown(cell: Cell) -> String {
    match cell {
        Cell::Value(value) => Shown(value).to_string(),
        Cell::Missing(reason) => reason.to_string(),
    }
}

impl State {
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::Missed => "MISSED",
            Self::NotShown => "NOT SHOWN",
        }
    }
}

impl Judged {
    /// What is judged.
    #[must_use]
    pub fn what(&self) -> String {
        match self.quantile {
            Some(1.0) => format!("{}, max", self.column),
            Some(quantile) => format!("{}, p{}", self.column, Shown(100.0 * quantile)),
            None => "fraction of PASS".to_owned(),
        }
    }
}

impl fmt::Display for Judged {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (state, what) = (self.state.word(), self.what());
        let (sign, limit) = match (self.max, self.below, self.min) {
            (Some(max), ..) => ("<=", max),
            (_, Some(below), _) => ("<", below),
            (.., min) => (">=", min.unwrap_or(0.0)),
        };
        let value = match self.value {
            Cell::Value(value) => Apart::new(value, Some(limit), None).to_string(),
            Cell::Missing(reason) => reason.to_string(),
        };
        let digits = Shown(limit).to_string();
        let is_exact = digits.parse() == Ok(limit);
        let limit = format!("{sign} {}", if is_exact { digits } else { limit.to_string() });
        write!(out, "{state:<10}{what:<36}{value:>12}   {limit:<12}")?;
        if let (Some([lower, upper]), Some(confidence)) = (self.interval, self.confidence) {
            let bound = |cell: Option<Cell>| cell.map_or_else(|| "unbounded".to_owned(), shown);
            write!(out, " {} to {} at {} %", bound(lower), bound(upper), Shown(100.0 * confidence))?;
        }
        for (what, name) in [("part", &self.part), ("variant", &self.variant)] {
            if let Some(name) = name {
                write!(out, "  {what} {name}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Missing;

    fn expectation(what: Statistic, judge: Judge) -> Expectation {
        Expectation { part: None, variant: None, what, confidence: Some(0.95), judge }
    }

    fn quantile(limit: Limit, judge: Judge) -> Expectation {
        expectation(Statistic::Quantile { column: "settle_time_s".to_owned(), quantile: 0.5, limit }, judge)
    }

    /// 1 to 100; the interval of the median is 40 to 61.
    fn hundred() -> Sorted {
        Sorted::new((1..=100).map(f64::from).collect(), [0; Missing::ALL.len()])
    }

    #[test]
    fn interval_that_holds_the_limit_shows_nothing() {
        let state = |limit, shown| {
            Judged::quantile(&quantile(Limit::Max(limit), shown), &hundred()).expect("runs").state
        };
        assert_eq!([50.0, 49.9].map(|limit| state(limit, Judge::Value)), [State::Met, State::Missed]);
        assert_eq!(
            [61.0, 60.9, 40.0, 39.9].map(|limit| state(limit, Judge::Interval)),
            [State::Met, State::NotShown, State::NotShown, State::Missed]
        );
    }

    #[test]
    fn limit_is_missed_at_its_value_only_if_it_must_not_be_reached_and_without_a_value() {
        let met = |limit| {
            Judged::quantile(&quantile(limit, Judge::Value), &hundred()).expect("runs").state == State::Met
        };
        assert!(met(Limit::Max(50.0)) && !met(Limit::Below(50.0)));
        let never = Sorted::new(Vec::new(), [0, 0, 3, 0, 0]);
        let judged = Judged::quantile(&quantile(Limit::Max(1e12), Judge::Value), &never).expect("runs");
        assert_eq!((judged.state, judged.value), (State::Missed, Cell::Missing(Missing::Never)));
    }

    #[test]
    fn missed_value_is_printed_beyond_its_limit() {
        let sorted = Sorted::new(vec![1.234_645; 3], [0; Missing::ALL.len()]);
        let line =
            |limit| Judged::quantile(&quantile(limit, Judge::Value), &sorted).expect("runs").to_string();
        assert!(line(Limit::Max(1.234_642)).contains(" 1.234645   <= 1.234642 "), "more digits of both");
        assert!(line(Limit::Max(1.3)).contains(" 1.2346   <= 1.3 "));
    }

    #[test]
    fn fraction_of_passes_is_judged_by_value_or_interval() {
        let state = |passes, shown| {
            let expectation = expectation(Statistic::Pass { least: 0.95 }, shown);
            Judged::pass(&expectation, passes, 1000).expect("runs").state
        };
        assert_eq!([950, 949].map(|passes| state(passes, Judge::Value)), [State::Met, State::Missed]);
        assert_eq!(
            [970, 950, 920].map(|passes| state(passes, Judge::Interval)),
            [State::Met, State::NotShown, State::Missed]
        );
    }
}
