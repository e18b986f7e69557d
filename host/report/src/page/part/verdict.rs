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
    let Some(summary) = &run.summary else {
        return html! { dl.facts { dt { "record" } dd { (run.name) } dt { "steps" } dd { (run.times_s().len()) } } };
    };
    let drive = summary.device.split(" (").next().unwrap_or(&summary.device);
    let speed = summary.simulated_s / summary.wall_s;
    html! {
        dl.facts {
            div { dt { "device" } dd { (drive) } }
            div { dt { "law" } dd { (summary.controller) } }
            div { dt { "simulated" } dd { (format!("{:.3}", summary.simulated_s)) " s" } }
            div { dt { "steps" } dd { (summary.steps) } }
            div { dt { "clock" } dd { (summary.timing.clock.replace('-', " ")) } }
            @if speed.is_finite() { div { dt { "speed" } dd { (format!("{speed:.1}")) " × real time" } } }
        }
    }
}
