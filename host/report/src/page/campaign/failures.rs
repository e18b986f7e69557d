//! The fraction of runs that fail, over each axis.

use lashloop_campaign::failures::{FailureAxis, Tally};
use maud::{Markup, html};

use super::super::typeset::percent;
use super::distributions::{COLOURS, tick};
use super::input::{CampaignResults, quantity};
use super::still::{Scale, Still, px};

/// Most marks of all plots, so that the page stays below 1 MB.
const MOST_MARKS: usize = 1_200;
const CONFIDENCE: f64 = 0.95;

pub(in super::super) fn section(results: &CampaignResults<'_>) -> Markup {
    let groups = &results.view.report.groups;
    let variants = results.campaign.variants.len();
    let has_failure = |part: usize| groups[part * variants..][..variants].iter().any(|it| it.pass < it.runs);
    let axes: Vec<_> = results.view.axes.iter().filter(|axis| has_failure(axis.part)).collect();
    let mut marks = 0;
    let shown = axes.iter().take_while(|axis| {
        marks += axis.bins.len() * variants;
        marks <= MOST_MARKS
    });
    let shown: Vec<_> = shown.collect();
    html! {
        section #failures {
            h2 { "Failures over the axes" }
            @if axes.is_empty() { p { "Every run has the verdict PASS." } } @else {
                p.legend { @for (at, variant) in results.campaign.variants.iter().enumerate() {
                    span.key { span class={ "run-key c" (at % COLOURS) } {} (variant.name) }
                } }
                div.stills { @for axis in &shown { (plot(results, axis)) } }
                p.note {
                    "Fraction of the runs of a bin whose verdict is not PASS, with its Clopper-Pearson interval at " (percent(CONFIDENCE)) "; all other axes vary within a bin."
                    @if shown.len() < axes.len() { " " (axes.len() - shown.len()) " further axes are in results.csv." }
                }
            }
        }
    }
}

fn plot(results: &CampaignResults<'_>, axis: &FailureAxis) -> Markup {
    let upper = axis.bins.iter().flat_map(|bin| &bin.tallies).filter(|tally| tally.runs > 0);
    let upper = upper.map(|tally| 100.0 * tally.interval(CONFIDENCE)[1]).fold(0.0, f64::max);
    let name = &results.campaign.file.parts[axis.part].name;
    let still = Still {
        width: 420.0,
        height: 210.0,
        x: Scale::Named((0..axis.bins.len()).map(|bin| range(axis, bin)).collect()),
        y: Scale::linear([0.0, upper.min(100.0)].into_iter(), 5),
    };
    let label = format!("Failures over {}, part {name}", axis.label);
    let content = html! {
        @for (at, bin) in axis.bins.iter().enumerate() {
            @for (variant, tally) in bin.tallies.iter().enumerate() { @if tally.runs > 0 {
                (mark(&still, results, at, (&range(axis, at), variant), *tally))
            } }
        }
    };
    html! {
        figure.still-figure {
            figcaption { strong { (axis.label) } " " small { "part " (name) } }
            (still.draw(&label, &quantity(&axis.label, &axis.unit, axis.times.as_deref()), "runs that fail, in %", &content))
        }
    }
}

fn mark(
    still: &Still,
    results: &CampaignResults<'_>,
    bin: usize,
    (range, variant): (&str, usize),
    tally: Tally,
) -> Markup {
    let count = results.campaign.variants.len();
    let x = px(still.x_px(bin as f64 + (variant as f64 + 1.0) / (count as f64 + 1.0)));
    let [low, high] = tally.interval(CONFIDENCE);
    let fraction = tally.fraction().unwrap_or(0.0);
    html! {
        g class={ "error-bar c" (variant % COLOURS) } {
            title { (results.campaign.variants[variant].name) ", " (range) ": " (tally.failures) " of " (tally.runs) " fail, " (percent(low)) " to " (percent(high)) }
            line x1=(x) x2=(x) y1=(px(still.y_px(100.0 * low))) y2=(px(still.y_px(100.0 * high))) {}
            circle cx=(x) cy=(px(still.y_px(100.0 * fraction))) r="3" {}
        }
    }
}

fn range(axis: &FailureAxis, bin: usize) -> String {
    let bin = &axis.bins[bin];
    if bin.from == bin.to { tick(&bin.from) } else { format!("{}\u{2013}{}", tick(&bin.from), tick(&bin.to)) }
}
