//! The runs whose records are kept: why, at which values, a picture, and the command that repeats them.

use lashloop_campaign::cell::Cell;
use maud::{Markup, html};

use super::super::input::Run;
use super::super::part::command::copied;
use super::super::typeset;
use super::super::why::{Tone, sentence, verdict};
use super::distributions::tick;
use super::input::{CampaignResults, number};
use super::still::{Scale, Still, path};

/// Most pictures, so that the page stays below 1 MB.
const MOST: usize = 20;
/// Groups of steps of a curve, of which each keeps its least and its greatest value.
const COLUMNS: usize = 110;

pub(in super::super) fn section(results: &CampaignResults<'_>) -> Markup {
    let kept: Vec<_> =
        results.evidence.iter().filter_map(|(case, run)| Some((*case, run.as_ref()?))).collect();
    html! {
        section #evidence {
            h2 { "Worst runs and failures" }
            @if kept.is_empty() { p { "No record of a run is kept; the section evidence of a campaign file sets how many are." } } @else {
                div.evidence { @for (case, run) in kept.iter().take(MOST) { (card(results, *case, run)) } }
                p.note {
                    "The worst runs first, then failures in the order of cases. Their records are in the folder evidence; "
                    code { "lashloop report" } " shows each with all its signals."
                    @if kept.len() > MOST { " " (kept.len() - MOST) " further records have no picture here." }
                }
            }
        }
    }
}

fn card(results: &CampaignResults<'_>, number_of_case: u64, run: &Run) -> Markup {
    let campaign = results.campaign;
    let Ok(case) = campaign.case(number_of_case) else { return html! {} };
    let (part, variant) = (&campaign.file.parts[case.part], &campaign.variants[case.variant].name);
    let rerun = [
        "lashloop".to_owned(),
        "campaign".to_owned(),
        "rerun".to_owned(),
        results.folder.display().to_string(),
        "--case".to_owned(),
        number_of_case.to_string(),
    ];
    let metric = campaign.file.evidence.of.as_deref();
    let metrics = run.record.summary.as_ref().map(|summary| &summary.metrics);
    html! {
        article data-case=(number_of_case) {
            h3 { span class={ "grade " (Tone::of(run).class()) } { (verdict(run)) } " case " (number_of_case) small { " " (part.name) " row " (case.row) ", " (variant) } }
            (picture(run, number_of_case))
            p.meaning { (sentence(run)) }
            dl.facts {
                @if let Some(value) = metric.and_then(|name| metrics?.get(name)) {
                    div { dt { code { (metric.unwrap_or_default()) } } dd { @match value { Some(value) => (number(Cell::Value(*value), None)), None => span.absent { "no value" } } } }
                }
                @for (axis, value) in part.axes.iter().zip(&case.values) {
                    div { dt { (axis.label.as_deref().unwrap_or(axis.name())) } dd { (tick(value)) " " (typeset::unit(&axis.unit)) } }
                }
            }
            (copied(&rerun))
        }
    }
}

/// Position with its reference, and torque.
fn picture(run: &Run, case: u64) -> Markup {
    let position = [("reference", "reference_rad"), ("c0", "load_position_rad")];
    html! {
        (plot(run, &format!("Case {case}: load position and reference"), "position in rad", &position))
        (plot(run, &format!("Case {case}: torque"), "torque in N m", &[("c1", "torque_nm")]))
    }
}

fn plot(run: &Run, label: &str, y_name: &str, columns: &[(&str, &str)]) -> Markup {
    let columns: Vec<_> =
        columns.iter().filter_map(|(class, name)| Some((*class, run.column(name)?))).collect();
    let times_s = run.times_s();
    if columns.is_empty() || times_s.len() < 2 {
        return html! {};
    }
    let ends = [times_s[0], times_s[times_s.len() - 1]];
    let still = Still {
        width: 420.0,
        height: 150.0,
        x: Scale::linear(ends.into_iter(), 6),
        y: Scale::linear(columns.iter().flat_map(|(_, values)| values.iter().copied()), 4),
    };
    let content = html! {
        @for (class, values) in &columns {
            path class={ "curve " (class) } d=(path(extremes(times_s, values).map(|(x, y)| (still.x_px(x), still.y_px(y))))) {}
        }
    };
    still.draw(label, "time in s", y_name, &content)
}

/// Least and greatest value of each group of steps, in the order of time.
fn extremes<'a>(times_s: &'a [f64], values: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
    let count = times_s.len().min(values.len());
    let size = count.div_ceil(COLUMNS).max(1);
    (0..count).step_by(size).flat_map(move |start| {
        let finite = || (start..count.min(start + size)).filter(|at| values[*at].is_finite());
        let low = finite().min_by(|a, b| values[*a].total_cmp(&values[*b]));
        let high = finite().max_by(|a, b| values[*a].total_cmp(&values[*b]));
        let mut kept: Vec<_> = low.into_iter().chain(high).collect();
        kept.sort_unstable();
        kept.dedup_by(|a, b| values[*a] == values[*b]);
        kept.into_iter().map(|at| (times_s[at], values[at]))
    })
}
