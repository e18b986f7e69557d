//! The verdict of a run, why, and the run's main facts.

use maud::{Markup, html};

use super::super::input::Run;
use super::super::why::{Tone, sentence, verdict};

pub(in super::super) fn section(run: &Run) -> Markup {
    let tone = Tone::of(run);
    html! {
        section class={ "verdict " (tone.class()) } {
            p.badge { (verdict(run)) @if tone == Tone::Marginal { small { "marginal" } } }
            div {
                h1 { (run.title()) }
                p.why { (sentence(run)) }
            }
            (facts(run))
        }
    }
}

fn facts(run: &Run) -> Markup {
    let (manifest, summary) = (&run.record.manifest, &run.summary);
    let device = summary.as_ref().map(|it| it.device.split(" (").next().unwrap_or(&it.device).to_owned());
    let speed = summary.as_ref().map(|it| it.simulated_s / it.wall_s).filter(|speed| speed.is_finite());
    let facts = [
        ("device", manifest.as_ref().map(|it| it.device.clone()).or(device)),
        (
            "law",
            manifest.as_ref().map(|it| it.law.clone()).or(summary.as_ref().map(|it| it.controller.clone())),
        ),
        ("simulated", summary.as_ref().map(|it| format!("{:.3} s", it.simulated_s))),
        ("steps", Some(summary.as_ref().map_or(run.times_s().len().to_string(), |it| it.steps.to_string()))),
        ("clock", summary.as_ref().map(|it| it.timing.clock.replace('-', " "))),
        ("speed", speed.map(|speed| format!("{speed:.1} \u{d7} real time"))),
        ("started", manifest.as_ref().map(|it| it.started.replace('T', " ").replace('Z', " UTC"))),
    ];
    html! {
        dl.facts { @for (name, fact) in facts {
            @if let Some(fact) = fact { div { dt { (name) } dd { (fact) } } }
        } }
    }
}
