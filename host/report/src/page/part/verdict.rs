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
    let (manifest, summary) = (&run.record.manifest, run.record.summary.as_ref());
    let speed = summary.map(|it| it.simulated_s / it.wall_s).filter(|speed| speed.is_finite());
    let facts = [
        ("device", Some(manifest.device.clone())),
        ("law", Some(manifest.law.clone())),
        ("simulated", summary.map(|it| format!("{:.3} s", it.simulated_s))),
        ("steps", Some(summary.map_or(run.times_s().len().to_string(), |it| it.steps.to_string()))),
        ("clock", Some(manifest.clock.to_string())),
        ("speed", speed.map(|speed| format!("{speed:.1} \u{d7} real time"))),
        ("started", Some(manifest.started.replace('T', " ").replace('Z', " UTC"))),
    ];
    html! {
        dl.facts { @for (name, fact) in facts {
            @if let Some(fact) = fact { div { dt { (name) } dd { (fact) } } }
        } }
    }
}
