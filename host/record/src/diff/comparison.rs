//! Two records compared.

use std::ops::RangeInclusive;

use lashloop_bench::verdict::Verdict;
use lashloop_plant::metrics::DRIVE_PREFIX;
use lashloop_session::names::UnknownName;
use serde::Serialize;

use super::error::DiffError;
use super::metrics::{self, MetricDifference};
use super::pairs::{Coverage, Pairs, microseconds, period_us};
use super::record_files::RecordFiles;
use super::scope::Scope;
use super::settings::{Setting, settings};
use super::signals::{At, SignalDifference, Signals, ValuePair};
use super::timing::{self, TimingDifference};
use super::tolerance::Tolerances;
use crate::reader::Record;
use crate::summary::RunEnd;
use crate::trace::TELEMETRY_TIME;

/// Half of the resolution of the times that are compared.
const HALF_US_S: f64 = 0.5e-6;

/// What to compare, and how far values may be apart.
#[derive(Debug, Clone, PartialEq)]
pub struct DiffOptions {
    /// Without one, values must be equal bit for bit.
    pub tolerances: Tolerances,
    /// Signals and metrics to compare; empty for all, and the verdict.
    pub only: Vec<String>,
    /// Part of the run to compare. Metrics and verdict are those of a whole run, so a part leaves them out.
    pub window_s: RangeInclusive<f64>,
    /// Judge only what is the same in each repetition of a run.
    pub deterministic: bool,
}

impl Default for DiffOptions {
    fn default() -> Self {
        Self {
            tolerances: Tolerances::default(),
            only: Vec::new(),
            window_s: f64::NEG_INFINITY..=f64::INFINITY,
            deterministic: false,
        }
    }
}

/// Two records compared: what was set differently, and what differs in the results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Whether the results are equal.
    pub agreement: Agreement,
    /// What is judged.
    #[serde(flatten)]
    pub scope: Scope,
    /// The records.
    pub records: [RecordHead; 2],
    /// What was set differently. Settings are not judged: two devices may give the same results.
    pub settings: Vec<Setting>,
    /// The metrics of both; none of an interrupted run.
    pub metrics: Vec<MetricDifference>,
    /// Whether metrics and verdict are judged.
    pub metrics_are_judged: bool,
    /// Link and timing of both, which are never judged.
    pub timing: Vec<TimingDifference>,
    /// The rows compared.
    pub coverage: Coverage,
    /// The first time at which a signal differs, and all that differ there.
    pub first: Option<FirstDifference>,
    /// The signals of both.
    pub signals: Vec<SignalDifference>,
    /// Signals that only the first, and only the second record has.
    pub signals_of_one: [Vec<String>; 2],
    /// Signals with another unit in the second record, which are not compared.
    pub signals_of_two_units: Vec<(String, [String; 2])>,
}

/// Whether two records have equal results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Agreement {
    /// Bit for bit.
    Bits,
    /// Within the tolerances.
    Tolerance,
    /// Not.
    Different,
}

/// What identifies a record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordHead {
    /// Its folder.
    pub name: String,
    /// The scenario.
    pub scenario: String,
    /// When it started.
    pub started: String,
    /// `None` if the run was interrupted before it had one.
    pub verdict: Option<Verdict>,
    /// The error that ended a run without a verdict; left out without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// How the run ended; `None` likewise.
    pub end: Option<RunEnd>,
    /// Rows of the whole record.
    pub rows: usize,
}

/// The first time at which a signal differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FirstDifference {
    /// When.
    #[serde(flatten)]
    pub at: At,
    /// Signals that differ there, in the order of the record: name, unit, values.
    pub signals: Vec<(String, String, [f64; 2])>,
}

impl Comparison {
    /// Compares two records.
    ///
    /// # Errors
    /// The records have no common time within the window, or the options name what neither has.
    pub fn new(records: &[RecordFiles; 2], options: &DiffOptions) -> Result<Self, DiffError> {
        let columns = records.each_ref().map(|it| &it.record.trace);
        let summaries = records.each_ref().map(|it| it.record.summary.as_ref());
        let metrics = match summaries {
            [Some(a), Some(b)] => metrics::compare([a, b], &options.tolerances),
            _ => Vec::new(),
        };
        check_names(options, columns.iter().flat_map(|it| it.signals()).map(|it| &*it.name), &metrics)?;
        let scope = if options.deterministic { Scope::deterministic(records) } else { Scope::All };
        let times_s = columns.map(|it| it.get("time_s").unwrap_or_default());
        let Pairs { rows, coverage } = Pairs::new(times_s, &options.window_s);
        if rows.is_empty() {
            return Err(no_common_time(records, times_s, options));
        }
        let telemetry_s = columns.map(|it| it.get(TELEMETRY_TIME));
        // In lockstep a value that is repeated until the next telemetry is repeated in the same steps.
        let is_fresh = |rows: [usize; 2]| {
            (0..2).all(|side| telemetry_s[side].is_none_or(|of| of[rows[side]] == times_s[side][rows[side]]))
        };
        let period_us = period_us(times_s[0]).unwrap_or(1);
        let signals = Signals::compare(
            columns,
            &rows,
            &options.tolerances,
            |row| {
                let time_s = times_s[0][row];
                At { step: microseconds(time_s).div_euclid(period_us), time_s }
            },
            |name| name != "time_s" && scope.has(name) && options.has(name),
            |name, rows| {
                scope.has_time(times_s[0][rows[0]])
                    && (scope == Scope::All || !name.starts_with(DRIVE_PREFIX) || is_fresh(rows))
            },
        );
        let is_whole = options.window_s == DiffOptions::default().window_s;
        let mut comparison = Self {
            agreement: Agreement::Different,
            scope,
            records: records.each_ref().map(RecordHead::new),
            settings: settings(records).into_iter().filter(|it| !it.is_same()).collect(),
            metrics: metrics.into_iter().filter(|it| options.has(&it.name)).collect(),
            metrics_are_judged: is_whole && scope == Scope::All,
            timing: timing::compare(summaries),
            coverage,
            first: first_difference(&signals.common),
            signals: signals.common,
            signals_of_one: signals.alone,
            signals_of_two_units: signals.other_unit,
        };
        let is_covered = match scope {
            // What either record lacks from there on is not judged.
            Scope::RealTime { until_s: Some(until_s) } => {
                let judged_s = *options.window_s.start()..=options.window_s.end().min(until_s - HALF_US_S);
                Pairs::new(times_s, &judged_s).coverage.is_equal()
            }
            _ => comparison.coverage.is_equal(),
        };
        comparison.agreement = comparison.agreement(is_covered, is_whole && options.only.is_empty());
        Ok(comparison)
    }

    /// Whether no value is judged.
    pub(super) fn judges_nothing(&self) -> bool {
        let has_metrics = self.metrics_are_judged && !self.metrics.is_empty();
        !has_metrics && self.signals.iter().all(|it| it.compared == 0)
    }

    /// `is_covered`: both records have every row that is judged. `ends_count`: so does the end of the run.
    fn agreement(&self, is_covered: bool, ends_count: bool) -> Agreement {
        let [a, b] = &self.records;
        let is_same_end = a.end.is_some() && a.end == b.end;
        let is_same_verdict = a.verdict.is_some() && a.verdict == b.verdict;
        let agrees = (is_covered || self.signals.is_empty())
            && !self.judges_nothing()
            && (!ends_count || (is_same_end && (!self.metrics_are_judged || is_same_verdict)))
            && (!self.metrics_are_judged || self.metrics.iter().all(|it| it.within))
            && self.signals.iter().all(|it| it.within)
            && self.signals_of_one.iter().all(Vec::is_empty)
            && self.signals_of_two_units.is_empty();
        let has_equal_bits = self.signals.iter().all(|it| it.differing == 0)
            && (!self.metrics_are_judged || self.metrics.iter().all(MetricDifference::has_equal_bits));
        match (agrees, has_equal_bits) {
            (false, _) => Agreement::Different,
            (true, true) => Agreement::Bits,
            (true, false) => Agreement::Tolerance,
        }
    }
}

impl DiffOptions {
    /// Checks the names against one record, before there is a second one.
    ///
    /// # Errors
    /// The record has no signal and no metric of such a name.
    pub fn check_names(&self, record: &RecordFiles) -> Result<(), DiffError> {
        let summary = record.record.summary.as_ref();
        let metrics = summary.map(|it| metrics::compare([it, it], &self.tolerances)).unwrap_or_default();
        let signals = record.record.trace.signals();
        Ok(check_names(self, signals.iter().map(|it| &*it.name), &metrics)?)
    }

    fn has(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|it| it == name)
    }
}

impl RecordHead {
    fn new(files: &RecordFiles) -> Self {
        let Record { manifest, summary, failure, trace, .. } = &files.record;
        Self {
            name: files.name.clone(),
            scenario: manifest.scenario.name.clone(),
            started: manifest.started.clone(),
            verdict: summary.as_ref().map(|it| it.verdict),
            failure: failure.as_ref().map(|it| it.error.clone()),
            end: summary.as_ref().map(|it| it.end.clone()),
            rows: trace.len(),
        }
    }
}

fn check_names<'a>(
    options: &'a DiffOptions,
    signals: impl Iterator<Item = &'a str>,
    metrics: &'a [MetricDifference],
) -> Result<(), UnknownName> {
    let mut known: Vec<_> = signals.filter(|name| *name != "time_s").collect();
    known.extend(metrics.iter().map(|it| &*it.name));
    let mut seen = std::collections::BTreeSet::new();
    known.retain(|name| seen.insert(*name));
    options.tolerances.check_names(&known)?;
    match options.only.iter().find(|name| !known.contains(&&***name)) {
        Some(name) => Err(UnknownName::new("the comparison", "signal or metric", name, known)),
        None => Ok(()),
    }
}

fn no_common_time(records: &[RecordFiles; 2], times_s: [&[f64]; 2], options: &DiffOptions) -> DiffError {
    let range = |of: &[f64]| [of.first(), of.last()].map(|time_s| time_s.copied().unwrap_or(f64::NAN));
    DiffError::NoCommonTime {
        names: records.each_ref().map(|it| it.name.clone()),
        ranges_s: times_s.map(range),
        from_s: options.window_s.start().max(0.0),
        until_s: *options.window_s.end(),
    }
}

fn first_difference(signals: &[SignalDifference]) -> Option<FirstDifference> {
    let firsts = || signals.iter().filter_map(|it| Some((it, it.first?)));
    let (_, ValuePair { at, .. }) = firsts().min_by(|(_, a), (_, b)| a.at.time_s.total_cmp(&b.at.time_s))?;
    let there = firsts().filter(|(_, first)| first.at == at);
    let signals = there.map(|(signal, first)| (signal.name.clone(), signal.unit.clone(), first.values));
    Some(FirstDifference { at, signals: signals.collect() })
}
