//! The injected faults over time.

use maud::{Markup, html};

use super::super::summary::{Fault, Summary};

pub(in super::super) fn section(summary: &Summary) -> Markup {
    html! {
        section #faults {
            h2 { "Injected faults" }
            @if summary.faults.is_empty() {
                p { "None." }
            } @else {
                ol.timeline { @for fault in &summary.faults { (row(fault, summary)) } }
                p.axis aria-hidden="true" { span { "0 s" } span { (format!("{:.3} s", summary.simulated_s)) } }
            }
        }
    }
}

fn row(fault: &Fault, summary: &Summary) -> Markup {
    let period_s = f64::from(summary.timing.period_us) * 1e-6;
    let at = |step: u64| {
        if summary.steps == 0 { 0.0 } else { (step as f64 / summary.steps as f64 * 100.0).min(100.0) }
    };
    let from = at(fault.step);
    let until = fault.until_step.map_or(100.0, at);
    let start_s = fault.step as f64 * period_s;
    html! {
        li {
            span.name { (fault.kind) }
            span.track aria-hidden="true" { span style=(format!("left:{from:.2}%;width:{:.2}%", until - from)) {} }
            span.when {
                button.jump type="button" data-time=(start_s) { (format!("{start_s:.3} s")) }
                " to "
                @match fault.until_step { Some(step) => (format!("{:.3} s", step as f64 * period_s)), None => "the end" }
                @if let Some(frames) = fault.frames { ", " (frames) " frames hit" }
            }
        }
    }
}
