//! The page of one run.

use lashloop_bench::timing::ClockName;
use maud::{Markup, html};

use super::chosen_panels::Panels;
use super::data::{Data, Part};
use super::input::Run;
use super::part::{expectations, faults, metrics, origin, plots, timing, verdict};
use super::run_charts::{Constant, charts};
use super::shell::{Link, document};
use super::typeset::{shown, unit as typeset_unit};
use super::why::verdict as verdict_of;

const LINKS: [Link; 7] = [
    ("expectations", "Expectations"),
    ("plots", "Plots"),
    ("timing", "Timing"),
    ("faults", "Faults"),
    ("metrics", "Metrics"),
    ("origin", "What was run"),
    ("repeat", "Run it again"),
];

/// The record of one run as a self-contained HTML document, with the user's panels in front.
#[must_use]
pub fn run(run: &Run, panels: &Panels) -> String {
    let (data, constants) = charts(run, panels);
    let has_rows = !run.times_s().is_empty();
    let content = html! {
        (verdict::section(run))
        @if let Some(summary) = &run.record.summary { (expectations::section(&summary.expectations)) }
        section #plots {
            h2 { "Plots" }
            @if has_rows {
                (plots::controls())
                (plots::charts(&data, Part::Motion))
                (plots::note(&data))
                (further(&data, &constants))
            } @else {
                p { "None: the run ended before its first torque." }
            }
        }
        section #timing {
            h2 { "Timing" }
            @if run.record.manifest.clock == ClockName::Lockstep {
                p { "In lockstep plant and drive wait for each other: the result doesn't depend on the timing." }
                details {
                    summary { "Timing of the exchange" }
                    (timings(run, &data))
                }
            } @else {
                (timings(run, &data))
            }
        }
        (faults::section(run))
        @if let Some(summary) = &run.record.summary { (metrics::section(summary)) }
        (origin::section(run))
        (origin::repeat(run))
    };
    let title = format!("{}: {}", verdict_of(run), run.title());
    let has_section = |(id, _): &&Link| {
        run.record.summary.is_some() || ["plots", "timing", "faults", "origin"].contains(id)
    };
    let links: Vec<_> = LINKS.iter().filter(has_section).copied().collect();
    document(&title, &links, has_rows.then_some(&data), &content)
}

fn timings(run: &Run, data: &Data) -> Markup {
    html! {
        @if plots::has(data, Part::Timing) { (plots::charts(data, Part::Timing)) }
        (timing::section(run))
    }
}

/// Signals that the other charts lack.
fn further(data: &Data, constants: &[Constant]) -> Markup {
    if !plots::has(data, Part::Further) && constants.is_empty() {
        return html! {};
    }
    html! {
        details open {
            summary { "Further signals" }
            (plots::charts(data, Part::Further))
            @if !constants.is_empty() {
                p.note { "Without a change: "
                    @for (at, Constant { name, value, unit }) in constants.iter().enumerate() {
                        @if at > 0 { ", " } code { (name) } " " (shown(*value)) " " (typeset_unit(unit))
                    }
                    "."
                }
            }
        }
    }
}
