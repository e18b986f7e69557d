//! The injected faults over time, and the texts of the drive.

use lashloop_bench::fault::timeline::FaultRecord;
use maud::{Markup, html};

use super::super::input::Run;

pub(in super::super) fn section(run: &Run) -> Markup {
    let faults = run.faults();
    let period_s = run.period_s();
    let steps = run.record.summary.as_ref().map_or(run.times_s().len() as u64, |summary| summary.steps);
    html! {
        section #faults {
            h2 { "Injected faults" }
            @if faults.is_empty() {
                p { "None." }
            } @else {
                ol.timeline { @for fault in &faults { (row(fault, steps, period_s)) } }
                p.axis aria-hidden="true" { span { "0 s" } span { (format!("{:.3} s", steps as f64 * period_s)) } }
            }
            @if !run.record.logs.is_empty() {
                h3 { "Texts of the drive" }
                ol.log { @for log in &run.record.logs { li {
                    button.jump type="button" data-time=(log.step as f64 * period_s) { (format!("{:.3} s", log.step as f64 * period_s)) }
                    " " (log.text)
                } } }
            }
        }
    }
}

fn row(fault: &FaultRecord, steps: u64, period_s: f64) -> Markup {
    let at = |step: u32| if steps == 0 { 0.0 } else { (f64::from(step) / steps as f64 * 100.0).min(100.0) };
    let from = at(fault.step);
    let until = fault.until_step.map_or(100.0, at);
    let start_s = f64::from(fault.step) * period_s;
    html! {
        li {
            span.name { (fault.kind) }
            span.track aria-hidden="true" { span style=(format!("left:{from:.2}%;width:{:.2}%", until - from)) {} }
            span.when {
                button.jump type="button" data-time=(start_s) { (format!("{start_s:.3} s")) }
                " to "
                @match fault.until_step { Some(step) => (format!("{:.3} s", f64::from(step) * period_s)), None => "the end" }
                @if let Some(frames) = fault.frames { ", " (frames) " frames hit" }
            }
        }
    }
}
