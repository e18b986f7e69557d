//! The verdict of a campaign, why, and its expectations.

use lashloop_campaign::cell::Cell;
use lashloop_campaign::expectation::{Judged, State};
use lashloop_campaign::report::Report;
use maud::{Markup, html};

use super::super::typeset::{self, percent, shown};
use super::super::why::Tone;
use super::input::{CampaignResults, number};

pub(in super::super) fn section(results: &CampaignResults<'_>) -> Markup {
    let report = &results.view.report;
    let verdict = report.verdict;
    let sum =
        |count: fn(&lashloop_campaign::report::Group) -> u64| report.groups.iter().map(count).sum::<u64>();
    let facts = [
        ("runs", report.cases.to_string()),
        ("PASS", sum(|group| group.pass).to_string()),
        ("FAIL", sum(|group| group.fail).to_string()),
        ("INVALID", sum(|group| group.invalid).to_string()),
        ("parts", results.campaign.file.parts.len().to_string()),
        ("variants", results.campaign.variants.len().to_string()),
        ("device", results.facts.device.clone()),
        ("seed", report.seed.to_string()),
    ];
    html! {
        section class={ "verdict " (Tone::of_verdict(verdict).class()) } {
            p.badge { (verdict) }
            div {
                h1 { (report.title) }
                p.why { (sentence(results)) }
            }
            dl.facts { @for (name, fact) in facts { div { dt { (name) } dd { (fact) } } } }
        }
    }
}

fn sentence(results: &CampaignResults<'_>) -> String {
    let report: &Report = &results.view.report;
    let count = report.expectations.len();
    let unmet: Vec<_> = report.expectations.iter().filter(|it| it.state != State::Met).collect();
    let Some((first, others)) = unmet.split_first() else {
        return match count {
            0 => {
                let failed = report.groups.iter().map(|group| group.runs - group.pass).sum::<u64>();
                format!(
                    "The campaign has no expectation; {failed} of {} runs are FAIL or INVALID.",
                    report.cases
                )
            }
            1 => "The expectation is met.".to_owned(),
            _ => format!("All {count} expectations are met."),
        };
    };
    let unit = unit(results, first);
    let value = match first.value {
        Cell::Value(value) if first.quantile.is_none() => percent(value),
        Cell::Value(value) => format!("{}{unit}", typeset::apart(value, None, first.max.or(first.below))),
        Cell::Missing(reason) => format!("without a value ({reason})"),
    };
    let (what, of) = (first.what(), of(first));
    let departure = match first.state {
        State::NotShown => {
            format!("{what}{of} is {value}, and its interval holds the limit, {}{unit}", limit(first))
        }
        _ => format!("{what}{of} is {value}, the limit is {}{unit}", limit(first)),
    };
    match others.len() {
        0 => format!("{departure}."),
        more => format!("{departure}; {more} more of {count} expectations not met."),
    }
}

/// Part and variant of an expectation.
fn of(judged: &Judged) -> String {
    match (&judged.part, &judged.variant) {
        (None, None) => String::new(),
        (Some(part), None) => format!(" of part {part}"),
        (None, Some(variant)) => format!(" of variant {variant}"),
        (Some(part), Some(variant)) => format!(" of part {part}, variant {variant}"),
    }
}

fn unit(results: &CampaignResults<'_>, judged: &Judged) -> String {
    let column = results.view.columns.iter().find(|it| it.name == judged.column);
    match column.map(|it| typeset::unit(&it.unit)) {
        Some(unit) if !unit.is_empty() => format!(" {unit}"),
        _ => String::new(),
    }
}

fn limit(judged: &Judged) -> String {
    match (judged.max, judged.below, judged.min) {
        (Some(max), ..) => format!("\u{2264} {}", shown(max)),
        (_, Some(below), _) => format!("< {}", shown(below)),
        (.., min) => format!("\u{2265} {}", percent(min.unwrap_or(0.0))),
    }
}

pub(in super::super) fn expectations(results: &CampaignResults<'_>) -> Markup {
    let judged = &results.view.report.expectations;
    html! {
        section #expectations {
            h2 { "Expectations" }
            @if judged.is_empty() { p { "The campaign has no expectation." } } @else {
                div.scroll { table.expectations.stacked {
                    thead { tr {
                        th scope="col" { "quantity" } th scope="col" { "result" } th.number scope="col" { "value" }
                        th.number scope="col" { "interval" } th.number scope="col" { "limit" } th.number scope="col" { "runs" }
                    } }
                    tbody { @for it in judged { (row(results, it)) } }
                } }
                p.note {
                    "Quantiles are of magnitudes, by nearest rank; a run without a value ranks behind every number. Intervals assume no \
                     distribution: order statistics for a quantile, Clopper-Pearson for a fraction. NOT SHOWN: the interval holds the limit."
                }
            }
        }
    }
}

fn row(results: &CampaignResults<'_>, judged: &Judged) -> Markup {
    let tone = match judged.state {
        State::Met => Tone::Pass,
        State::Missed => Tone::Fail,
        State::NotShown => Tone::Marginal,
    };
    let bound = |cell: Option<Cell>| match cell {
        Some(cell) => number(cell, None),
        None => html! { span.absent { "unbounded" } },
    };
    html! {
        tr class=(tone.class()) {
            th scope="row" { (judged.what()) small { (of(judged)) } }
            td { span class={ "grade " (tone.class()) } { (tone.symbol()) " " (judged.state.word()) } }
            td.number data-label="value" { (number(judged.value, judged.max.or(judged.below).or(judged.min))) (unit(results, judged)) }
            td.number data-label="interval" {
                @if let (Some([low, high]), Some(confidence)) = (judged.interval, judged.confidence) {
                    (bound(low)) " to " (bound(high)) " " small { "at " (percent(confidence)) }
                }
            }
            td.number data-label="limit" { (limit(judged)) (unit(results, judged)) }
            td.number data-label="runs" { (judged.runs) }
        }
    }
}
