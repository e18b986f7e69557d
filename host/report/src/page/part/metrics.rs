//! All metrics of one or several runs.

use std::collections::BTreeSet;

use lashloop_plant::metrics::Metric;
use lashloop_record::summary::Summary;
use maud::{Markup, html};

use super::super::input::Run;
use super::super::typeset::{percent, shown, unit};
use super::expectations::value;

/// A metric as a table shows it.
struct Row<'a> {
    name: &'a str,
    unit: &'a str,
    meaning: &'a str,
}

/// Metrics with a value in one of the summaries: those of this version in their order, then unknown ones.
fn rows<'a>(summaries: &[&'a Summary]) -> Vec<Row<'a>> {
    let with_value = |summary: &&'a Summary| summary.metrics.iter().filter(|(_, value)| value.is_some());
    let mut present: BTreeSet<&str> =
        summaries.iter().flat_map(with_value).map(|(name, _)| &**name).collect();
    let known = Metric::ALL.iter().filter(|metric| present.remove(metric.name()));
    let mut rows: Vec<_> =
        known.map(|it| Row { name: it.name(), unit: it.unit(), meaning: it.meaning() }).collect();
    rows.extend(present.into_iter().map(|name| Row { name, unit: "", meaning: "" }));
    rows
}

/// The metrics of a run, each with its definition.
pub(in super::super) fn section(summary: &Summary) -> Markup {
    let absent = summary.metrics_without_value.iter();
    html! {
        section #metrics {
            h2 { "Metrics" }
            div.scroll { table.metrics.stacked {
                thead { tr { th scope="col" { "metric" } th.number scope="col" { "value" } th scope="col" { "definition" } } }
                tbody { @for row in rows(&[summary]) { tr {
                    th scope="row" { code { (row.name) } }
                    td.number data-metric=(row.name) { (value(summary.metric(row.name), row.unit, None)) }
                    td.meaning { (row.meaning) }
                } } }
            } }
            @if !summary.metrics_without_value.is_empty() {
                p.note { "Without a value: "
                    @for (at, (name, reason)) in absent.enumerate() { @if at > 0 { ", " } code { (name) } " (" (reason) ")" }
                    "."
                }
            }
        }
    }
}

/// The metrics of several runs side by side; the difference is to the first.
pub(in super::super) fn side_by_side(runs: &[Run]) -> Markup {
    let summaries: Vec<_> = runs.iter().filter_map(|run| run.record.summary.as_ref()).collect();
    let of = |run: &Run, name: &str| run.record.summary.as_ref().and_then(|it| it.metric(name));
    html! {
        section #metrics {
            h2 { "Metrics" }
            div.scroll { table.metrics {
                thead { tr {
                    th scope="col" { "metric" } th scope="col" { "unit" }
                    @for (number, run) in runs.iter().enumerate() {
                        th.number scope="col" { span class={ "run-key c" (number % 8) } {} (run.name) }
                        @if number > 0 { th.number scope="col" { "difference" } }
                    }
                } }
                tbody { @for row in rows(&summaries) { tr {
                    th scope="row" { code { (row.name) } }
                    td { (unit(row.unit)) }
                    @for (number, run) in runs.iter().enumerate() {
                        td.number data-metric=(row.name) { (value(of(run, row.name), "", reason(run, row.name))) }
                        @if number > 0 { td.number { (difference(of(&runs[0], row.name), of(run, row.name))) } }
                    }
                } } }
            } }
            p.note { "Differences are relative to " (runs.first().map_or("", |run| &run.name)) "." }
        }
    }
}

fn reason<'a>(run: &'a Run, name: &str) -> Option<&'a str> {
    run.record.summary.as_ref()?.metrics_without_value.get(name).map(String::as_str)
}

fn difference(first: Option<f64>, other: Option<f64>) -> Markup {
    let Some((first, other)) = first.zip(other) else { return html! {} };
    let difference = other - first;
    if difference == 0.0 {
        return html! { span.absent { "equal" } };
    }
    let sign = if difference > 0.0 { "+" } else { "" };
    let relative = (first != 0.0).then(|| difference / first.abs()).filter(|relative| relative.abs() < 100.0);
    html! {
        data value=(difference) { (sign) (shown(difference)) }
        @if let Some(relative) = relative { " " small { "(" (sign) (percent(relative)) ")" } }
    }
}
