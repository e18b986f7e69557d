//! The result of a comparison: what differs, where first and how far.

use lashloop_record::diff::{
    Agreement, Comparison, DiffOptions, FirstDifference, MetricDifference, SignalDifference, exact,
};
use maud::{Markup, html};

use super::super::typeset::{shown, unit};

/// A quantity that differs.
struct Row<'a> {
    name: &'a str,
    unit: &'a str,
    values: [Option<f64>; 2],
    allowed: Option<f64>,
    within: bool,
    place: Place,
}

/// Where a quantity differs.
enum Place {
    /// A signal: the time of its largest difference, and how many rows differ.
    Rows { at_s: Option<f64>, differing: usize, compared: usize },
    /// A metric.
    WholeRun,
}

pub(in super::super) fn section(comparison: &Comparison, options: &DiffOptions) -> Markup {
    let class = if comparison.agreement == Agreement::Different { "fail" } else { "pass" };
    html! {
        section #result {
            h2 { "Result" }
            p.result { span class={ "grade " (class) } { (comparison.result()) } }
            (judged(comparison, options))
            @if let Some(first) = &comparison.first { (first_difference(first)) }
            (largest(comparison))
            @for (letter, names) in ["A", "B"].iter().zip(&comparison.signals_of_one) {
                @if !names.is_empty() { p { "Only in " (letter) ": " (names.join(", ")) } }
            }
            @for (name, [a, b]) in &comparison.signals_of_two_units {
                p { "Not compared: " code { (name) } " is in " (unit(a)) " in A and in " (unit(b)) " in B." }
            }
        }
    }
}

fn judged(comparison: &Comparison, options: &DiffOptions) -> Markup {
    let (from_s, until_s) = (options.window_s.start(), options.window_s.end());
    html! {
        p { "A is " (comparison.records[0].name) ", B is " (comparison.records[1].name) "." }
        @if from_s.is_finite() || until_s.is_finite() {
            p { "Window: "
                @if from_s.is_finite() { "from " (shown(*from_s)) " s " }
                @if until_s.is_finite() { "until " (shown(*until_s)) " s" }
            }
        }
        @if !options.only.is_empty() { p { "Compared: " (options.only.join(", ")) } }
        @for line in comparison.extent().lines() { p { (line) } }
        @if !comparison.metrics_are_judged { p { "Metrics and verdict are not judged." } }
    }
}

fn first_difference(first: &FirstDifference) -> Markup {
    html! {
        h3 { "First difference: step " (first.at.step) ", " (jump(first.at.time_s)) }
        div.scroll { table.first.stacked {
            thead { tr { th scope="col" { "signal" } th.number scope="col" { "A" } th.number scope="col" { "B" } th scope="col" { "unit" } } }
            tbody { @for (name, of_unit, values) in &first.signals { tr {
                th scope="row" { code { (name) } }
                (cells(values.map(Some)))
                td { (unit(of_unit)) }
            } } }
        } }
    }
}

fn largest(comparison: &Comparison) -> Markup {
    let signals = comparison.signals.iter().filter(|it| it.differing > 0).map(of_signal);
    let is_shown = |it: &&MetricDifference| comparison.metrics_are_judged && !it.has_equal_bits();
    let rows: Vec<_> = signals.chain(comparison.metrics.iter().filter(is_shown).map(of_metric)).collect();
    html! {
        h3 { "Largest differences" }
        @if rows.is_empty() { p { "None." } } @else {
            div.scroll { table.differences.stacked {
                thead { tr {
                    th scope="col" { "quantity" } th.number scope="col" { "B \u{2212} A" } th.number scope="col" { "allowed" } th scope="col" { "unit" }
                    th scope="col" { "result" } th.number scope="col" { "at" } th.number scope="col" { "A" } th.number scope="col" { "B" }
                    th.number scope="col" { "rows" }
                } }
                tbody { @for row in &rows { (difference(row)) } }
            } }
        }
    }
}

fn of_signal(it: &SignalDifference) -> Row<'_> {
    Row {
        name: &it.name,
        unit: &it.unit,
        values: it.largest.map_or([None; 2], |largest| largest.values.map(Some)),
        allowed: it.tolerance,
        within: it.within,
        place: Place::Rows {
            at_s: it.largest.map(|largest| largest.at.time_s),
            differing: it.differing,
            compared: it.compared,
        },
    }
}

fn of_metric(it: &MetricDifference) -> Row<'_> {
    let MetricDifference { name, unit, values, tolerance, within, .. } = it;
    Row { name, unit, values: *values, allowed: *tolerance, within: *within, place: Place::WholeRun }
}

fn difference(row: &Row<'_>) -> Markup {
    let apart = row.values[0].zip(row.values[1]).map(|(a, b)| b - a);
    let (class, word) = if row.within { ("pass", "within") } else { ("fail", "different") };
    html! {
        tr {
            th scope="row" { code { (row.name) } }
            td.number data-label="B \u{2212} A" { @match apart { Some(apart) => data value=(apart) { (shown(apart)) }, None => span.absent { "no value in one" } } }
            td.number data-label="allowed" { @match row.allowed { Some(allowed) => (shown(allowed)), None => "equal bits" } }
            td { (unit(row.unit)) }
            td { span class={ "grade " (class) } { (word) } }
            @match row.place {
                Place::Rows { at_s: Some(at_s), .. } => td.number data-label="at" { (jump(at_s)) },
                Place::Rows { at_s: None, .. } => td.number { "\u{2013}" },
                Place::WholeRun => td.number { "whole run" },
            }
            (cells(row.values))
            @match row.place {
                Place::Rows { differing, compared, .. } => td.number data-label="rows" { (differing) " of " (compared) },
                Place::WholeRun => td {},
            }
        }
    }
}

/// Two values with as many digits as distinguish them.
fn cells(values: [Option<f64>; 2]) -> Markup {
    let texts = match values {
        [Some(a), Some(b)] => exact([a, b]).map(Some),
        values => values.map(|value| value.map(shown)),
    };
    html! {
        @for ((letter, value), text) in ["A", "B"].iter().zip(&values).zip(texts) {
            td.number data-label=(letter) { @match value.zip(text) {
                Some((value, text)) => data value=(value) { (text.replace('-', "\u{2212}")) },
                None => span.absent { "none" },
            } }
        }
    }
}

/// A time that the plots show on a click.
fn jump(time_s: f64) -> Markup {
    html! { button.jump type="button" data-time=(time_s) { (format!("{time_s:.3} s")) } }
}
