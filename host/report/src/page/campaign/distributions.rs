//! Quantiles and distributions of each metric.

use std::fmt::Write as _;

use lashloop_bench::number::Shown;
use lashloop_campaign::report::{ColumnQuantiles, Group};
use lashloop_campaign::settings::Limit;
use lashloop_campaign::view::{ColumnView, Distribution};
use lashloop_plant::metrics::Metric;
use maud::{Markup, html};

use super::super::typeset;
use super::input::{CampaignResults, limit, number, quantity};
use super::still::{Scale, Still, px};

/// Most rows of all tables, and most points of all curves, so that the page stays below 1 MB.
const MOST_ROWS: usize = 300;
const MOST_POINTS: usize = 12_000;
/// Colours of curves.
pub(super) const COLOURS: usize = 8;

pub(in super::super) fn section(results: &CampaignResults<'_>) -> Markup {
    let columns = shown(results);
    let all = results.view.columns.len();
    html! {
        section #distributions {
            h2 { "Distributions" }
            @if columns.is_empty() { p { "No run has a value of any metric." } } @else {
                (choice("metric", &columns.iter().map(|it| it.name.as_str()).collect::<Vec<_>>()))
                @for column in &columns { (of_column(results, column)) }
                p.note {
                    "Magnitudes. A curve at 0.95 shows the value that 95 % of the runs don't exceed; it ends below 1 if runs have no value."
                    @if columns.len() < all { " " (all - columns.len()) " further metrics are in report.json." }
                }
            }
        }
    }
}

/// Metrics up to the limits of the page, at least one.
fn shown<'a>(results: &CampaignResults<'a>) -> Vec<&'a ColumnView> {
    let (mut rows, mut points) = (0, 0);
    let mut columns = Vec::new();
    for column in &results.view.columns {
        rows += results.view.report.groups.len();
        points += column.distributions.iter().map(|it| it.points.len()).sum::<usize>();
        if !columns.is_empty() && (rows > MOST_ROWS || points > MOST_POINTS) {
            break;
        }
        columns.push(column);
    }
    columns
}

/// A choice between blocks; without a script all of them are there.
pub(super) fn choice(name: &str, options: &[&str]) -> Markup {
    html! {
        @if options.len() > 1 {
            p.choose hidden { label { (name) " " select data-choose=(name) { @for option in options { option { (option) } } } } }
        }
    }
}

fn of_column(results: &CampaignResults<'_>, column: &ColumnView) -> Markup {
    let groups = &results.view.report.groups;
    let variants = results.campaign.variants.len();
    let meaning =
        Metric::ALL.iter().find(|metric| metric.name() == column.name).map(|metric| metric.meaning());
    html! {
        div data-choice=(column.name) {
            h3 { code { (column.name) } @if !column.unit.is_empty() { " in " (typeset::unit(&column.unit)) } }
            @if let Some(meaning) = meaning { p.meaning { (meaning) } }
            div.scroll { table.quantiles {
                thead { tr {
                    th scope="col" { "part, variant" }
                    @for name in ["runs", "median", "p80", "p95", "p99", "max", "without a value", "limit"] { th.number scope="col" { (name) } }
                } }
                tbody { @for (at, group) in groups.iter().enumerate().take(MOST_ROWS) {
                    @if let Some(it) = group.columns.iter().find(|it| it.column == column.name) { (row(results, column, at, group, it)) }
                } }
            } }
            div.stills.wide { @for (part, distributions) in column.distributions.chunks(variants).enumerate().take(MOST_ROWS / variants.max(1)) {
                (curves(results, column, part, distributions))
            } }
        }
    }
}

fn row(
    results: &CampaignResults<'_>,
    column: &ColumnView,
    at: usize,
    group: &Group,
    it: &ColumnQuantiles,
) -> Markup {
    let bound = column.limits[at];
    let missing: Vec<_> = it.missing.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let quantiles =
        [("median", it.median), ("p80", it.p80), ("p95", it.p95), ("p99", it.p99), ("max", it.max)];
    html! {
        tr data-part=(group.part) data-variant=(group.variant) {
            th scope="row" { span class={ "run-key c" (at % results.campaign.variants.len() % COLOURS) } {} (results.name(group)) }
            td.number { (group.runs) }
            @for (name, cell) in quantiles { td.number data-quantile=(name) { (number(cell, bound.map(Limit::value))) } }
            td.number { (missing.join(", ")) }
            td.number { @if let Some(bound) = bound { (limit(bound)) } }
        }
    }
}

/// Cumulative distributions of the variants on one pair of axes.
fn curves(
    results: &CampaignResults<'_>,
    column: &ColumnView,
    part: usize,
    distributions: &[Distribution],
) -> Markup {
    if distributions.iter().all(|it| it.points.len() < 3) {
        return html! {};
    }
    let variants = results.campaign.variants.len();
    let limits = &column.limits[part * variants..][..variants];
    let bounds = limits.iter().flatten().map(|limit| limit.value());
    let mut values: Vec<_> =
        distributions.iter().flat_map(|it| &it.points).map(|[value, _]| *value).chain(bounds).collect();
    values.sort_unstable_by(f64::total_cmp);
    let still = Still {
        width: 560.0,
        height: 270.0,
        x: Scale::of_sorted(&values),
        y: Scale::linear([0.0, 1.0].into_iter(), 5),
    };
    let name = &results.campaign.file.parts[part].name;
    let label = format!("Cumulative distribution of {}, part {name}", column.name);
    let content = html! {
        @for (at, bound) in limits.iter().enumerate() { @if let Some(bound) = bound {
            @let x = px(still.x_px(bound.value()));
            line class={ "curve dashed " (colour(limits, at)) } x1=(x) x2=(x) y1=(px(still.y_px(1.0))) y2=(px(still.y_px(0.0))) {
                title { "limit " (limit(*bound)) }
            }
        } }
        @for (at, it) in distributions.iter().enumerate() { @if !it.points.is_empty() {
            path class={ "curve c" (at % COLOURS) } d=(steps(&still, it)) { title { (results.campaign.variants[at].name) } }
        } }
    };
    html! {
        figure.still-figure {
            figcaption { strong { (name) }
                @for (at, it) in distributions.iter().enumerate() { @if !it.points.is_empty() {
                    span.key { span class={ "run-key c" (at % COLOURS) } {} (results.campaign.variants[at].name) }
                } }
                @if limits.iter().any(Option::is_some) { span.key { "limits are dashed" } }
            }
            (still.draw(&label, &quantity(&column.name, &column.unit, None), "fraction of runs", &content))
        }
    }
}

/// A limit of all variants has no variant's colour.
fn colour(limits: &[Option<Limit>], at: usize) -> String {
    if limits.iter().all(|it| *it == limits[at]) {
        "reference".to_owned()
    } else {
        format!("c{}", at % COLOURS)
    }
}

/// Up at each value.
fn steps(still: &Still, distribution: &Distribution) -> String {
    let mut text = String::new();
    for (at, [value, fraction]) in distribution.points.iter().enumerate() {
        let (x, y) = (px(still.x_px(*value)), px(still.y_px(*fraction)));
        // A string takes every text.
        let _ = match at {
            0 => write!(text, "M{x} {}V{y}", px(still.y_px(0.0))),
            _ => write!(text, "H{x}V{y}"),
        };
    }
    text
}

/// A value of an axis with few digits.
pub(super) fn tick(value: &lashloop_campaign::axis::AxisValue) -> String {
    match value.number() {
        Some(number) => {
            let short: f64 = format!("{number:.2e}").parse().unwrap_or(number);
            // Counts keep their digits.
            Shown(if number.fract() == 0.0 { number } else { short }).to_string().replace('-', "\u{2212}")
        }
        None => value.to_string(),
    }
}
