//! The comparison as a text: tables whose columns are as wide as their content, and the result as the last line.

use std::fmt;

use lashloop_bench::text_table::aligned;
use lashloop_session::{counted, printable};
use serde::Serialize as _;

use super::comparison::{Agreement, Comparison, RecordHead};
use super::figure::{exact, figure};
use super::metrics::MetricDifference;
use super::scope::Scope;
use super::settings::Group;
use super::signals::SignalDifference;
use crate::summary::RunEnd;

/// Longest text of a setting in a table.
const LONGEST: usize = 60;

impl fmt::Display for Comparison {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_heads(out)?;
        self.write_settings(out)?;
        self.write_metrics(out)?;
        self.write_timing(out)?;
        self.write_coverage(out)?;
        self.write_signals(out)?;
        write!(out, "\n{}", self.result())
    }
}

impl Comparison {
    /// The result as a line.
    #[must_use]
    pub fn result(&self) -> &'static str {
        match (self.agreement, self.scope) {
            (Agreement::Bits, Scope::All) => "EQUAL bit for bit",
            (Agreement::Bits, _) => "EQUAL bit for bit in what is judged",
            (Agreement::Tolerance, _) => "EQUAL within the tolerance",
            (Agreement::Different, _) if self.judges_nothing() => "DIFFERENT: nothing can be judged",
            (Agreement::Different, _) => "DIFFERENT",
        }
    }

    /// The rows compared, and what of them is judged, in lines.
    #[must_use]
    pub fn extent(&self) -> String {
        struct Extent<'a>(&'a Comparison);
        impl fmt::Display for Extent<'_> {
            fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.write_coverage(out)
            }
        }
        Extent(self).to_string().trim().to_owned()
    }

    fn write_heads(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (letter, head) in ["A", "B"].iter().zip(&self.records) {
            let verdict = match (&head.verdict, &head.failure) {
                (Some(verdict), _) => verdict.to_string(),
                (None, Some(failure)) => format!("no verdict: {failure}"),
                (None, None) => "no verdict, the run was interrupted".to_owned(),
            };
            let end = head.end.as_ref().and_then(RunEnd::early).map(|end| format!(" ({end})"));
            let RecordHead { name, rows, scenario, started, .. } = head;
            let end = end.unwrap_or_default();
            let rows = counted(*rows as u64, "row");
            let line = format!("{letter}  {name}: {verdict}{end}; {rows}; {scenario}; {started}");
            writeln!(out, "{}", printable(&line))?;
        }
        Ok(())
    }

    fn write_settings(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.settings.is_empty() {
            return writeln!(out, "\nSet differently: nothing");
        }
        let rows = self.settings.iter().map(|it| {
            let value = |side: usize| it.values[side].as_ref().map_or_else(|| "-".to_owned(), |it| short(it));
            [it.group.to_string(), it.key.clone(), value(0), value(1)]
        });
        write_table(out, "\nSet differently", ["", "", "A", "B"], rows, 4)
    }

    fn write_metrics(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.metrics.is_empty() {
            return Ok(());
        }
        let (with, without): (Vec<_>, Vec<_>) = self.metrics.iter().partition(|it| it.values != [None; 2]);
        let title = if self.metrics_are_judged { "\nMetrics" } else { "\nMetrics (not judged)" };
        let rows = with.into_iter().map(|it| it.row(self.metrics_are_judged));
        write_table(out, title, ["", "A", "B", "B - A", "", ""], rows, 1)?;
        if without.is_empty() {
            Ok(())
        } else {
            writeln!(out, "  without a value in both: {}", without.len())
        }
    }

    fn write_timing(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.timing.is_empty() {
            return Ok(());
        }
        let rows = self.timing.iter().map(|it| {
            let [a, b] = it.values.map(|value| value.map_or_else(|| "-".to_owned(), figure));
            [it.name.to_owned(), a, b]
        });
        write_table(out, "\nTiming and link (not judged)", ["", "A", "B"], rows, 1)
    }

    fn write_coverage(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let coverage = &self.coverage;
        writeln!(out, "\nRows compared: {}", coverage.compared)?;
        if let [Some(a), Some(b)] = coverage.period_us
            && a != b
        {
            writeln!(out, "Other periods: {a} us in A, {b} us in B; compared are the times of both")?;
        }
        for (side, letter) in ["A", "B"].iter().enumerate() {
            let (outside, between) = (coverage.outside[side], coverage.between[side]);
            if !coverage.is_equal() && outside > 0 {
                let last =
                    coverage.last_s[1 - side].map(|last_s| format!(", which ends at {} s", figure(last_s)));
                let other = ["B", "A"][side];
                writeln!(
                    out,
                    "Only in {letter}: {outside} rows before or after those of {other}{}",
                    last.unwrap_or_default()
                )?;
            }
            if !coverage.is_equal() && between > 0 {
                writeln!(out, "Only in {letter}: {between} rows between those of the other record")?;
            }
        }
        match self.scope {
            Scope::All => {}
            Scope::RealTime { until_s } => {
                writeln!(
                    out,
                    "Judged: reference, positions, torque and truth, and the drive's signals at the step of their telemetry; in \
                     real time the rest differs from run to run"
                )?;
                if let Some(until_s) = until_s {
                    writeln!(
                        out,
                        "Judged until {} s, the first step without a torque in time",
                        figure(until_s)
                    )?;
                }
            }
            Scope::Hardware => {
                writeln!(out, "Judged: the reference; positions and torques of hardware are measured")?;
            }
        }
        Ok(())
    }

    fn write_signals(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (letter, names) in ["A", "B"].iter().zip(&self.signals_of_one) {
            if !names.is_empty() {
                writeln!(out, "Only in {letter}: {}", printable(&names.join(", ")))?;
            }
        }
        for (name, [a, b]) in &self.signals_of_two_units {
            let line = format!("Not compared: {name} is in {a} in A and in {b} in B");
            writeln!(out, "{}", printable(&line))?;
        }
        if let Some(first) = &self.first {
            writeln!(out, "\nFirst difference: step {}, {} s", first.at.step, figure(first.at.time_s))?;
            let rows = first.signals.iter().map(|(name, unit, values)| {
                let [a, b] = exact(*values);
                [name.clone(), a, b, unit.clone()]
            });
            write_table(out, "", ["", "A", "B", ""], rows, 1)?;
        }
        let differing: Vec<_> = self.signals.iter().filter(|it| it.differing > 0).collect();
        let equal = self.signals.len() - differing.len();
        if differing.is_empty() {
            return writeln!(out, "Signals: all {equal} equal bit for bit");
        }
        write_table(
            out,
            "\nLargest differences",
            ["", "B - A", "", "step", "s", "A", "B", "rows", ""],
            differing.iter().map(|it| it.row()),
            1,
        )?;
        if equal > 0 { writeln!(out, "Equal bit for bit: {equal} further signals") } else { Ok(()) }
    }
}

impl MetricDifference {
    fn row(&self, is_judged: bool) -> [String; 6] {
        let [a, b] = match self.values {
            [Some(a), Some(b)] if a.to_bits() != b.to_bits() => exact([a, b]),
            values => values.map(|it| it.map_or_else(|| "-".to_owned(), figure)),
        };
        let difference = self.difference().map_or_else(|| "-".to_owned(), figure);
        let mut mark = if self.within || !is_judged { String::new() } else { beyond(self.tolerance) };
        if let Some(reason) = self.reasons.iter().flatten().next() {
            mark += &format!(" ({reason})");
        }
        [self.name.clone(), a, b, difference, self.unit.clone(), mark]
    }
}

impl SignalDifference {
    fn row(&self) -> [String; 9] {
        let mark = if self.within { String::new() } else { beyond(self.tolerance) };
        let counted = format!("{} of {}", self.differing, self.compared);
        let Some(largest) = self.largest else {
            let [a, b] = self.absent;
            let mut row: [String; 9] = Default::default();
            row[0].clone_from(&self.name);
            row[1] = format!("no value in {a} rows of A, {b} of B");
            [row[7], row[8]] = [counted, mark];
            return row;
        };
        let [a, b] = exact(largest.values);
        let (step, time_s) = (largest.at.step.to_string(), figure(largest.at.time_s));
        let difference = figure(largest.difference());
        [self.name.clone(), difference, self.unit.clone(), step, time_s, a, b, counted, mark]
    }
}

fn beyond(tolerance: Option<f64>) -> String {
    tolerance.map_or_else(|| "DIFFERENT".to_owned(), |limit| format!("BEYOND {}", figure(limit)))
}

impl fmt::Display for Group {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}

/// A text that fits into a table. A hash differs in its first digits.
fn short(text: &str) -> String {
    let text = text.replace('\n', " ");
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// Writes a table with a title and the heads of its columns. The first `left` columns are aligned to the left, and the last.
fn write_table<const N: usize>(
    out: &mut fmt::Formatter<'_>,
    title: &str,
    heads: [&str; N],
    rows: impl Iterator<Item = [String; N]>,
    left: usize,
) -> fmt::Result {
    let mut table = vec![heads.map(str::to_owned)];
    table.extend(rows.map(|row| row.map(|cell| printable(&cell))));
    if !title.is_empty() {
        writeln!(out, "{title}")?;
    }
    for line in aligned(&table, |column| column >= left && column < N - 1) {
        writeln!(out, "  {line}")?;
    }
    Ok(())
}
