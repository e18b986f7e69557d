//! The report of a run on standard output: the verdict, what it rests on, and the metrics that have a value.

use lashloop_bench::number::Shown;
use lashloop_bench::run::{End, Outcome};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::timing::ClockName;
use lashloop_bench::verdict::{LinkCounts, Verdict};
use lashloop_record::summary::{Summary, Telemetry};
use lashloop_session::{CapturedRows, counted};

use super::colour::{self, Stream};
use super::output::{outln, styled_line};

pub(super) fn print(scenario: &Scenario, summary: &Summary, outcome: &Outcome, has_details: bool) {
    let is_judged = summary.verdict != Verdict::Pass || !summary.expectations.is_empty();
    let verdict = if is_judged {
        summary.verdict.to_string()
    } else {
        format!("{}, nothing expected", summary.verdict)
    };
    let verdict = colour::of_verdict(summary.verdict, &verdict, Stream::Output);
    styled_line(&verdict, format_args!("  {}", scenario.title));
    if !is_judged {
        outln!("note   no [[expect]] judges the drive");
    }
    for finding in &summary.expectations {
        outln!("{} {finding}", if finding.ok { "ok    " } else { "MISSED" });
    }
    for breach in &outcome.judgement.breaches {
        outln!("BROKEN {breach}");
    }
    if let Some(reason) = &outcome.judgement.gate {
        outln!("GATE   {reason}");
    }
    if outcome.end != End::Complete {
        outln!("ENDED  {}", outcome.end);
    }
    for fault in &summary.faults {
        let until = fault.until_step.map_or_else(|| "the end".to_owned(), |step| format!("step {step}"));
        let frames = fault.frames.map_or_else(String::new, |frames| format!(", {frames} frames hit"));
        outln!("fault  {} from step {} to {until}{frames}", fault.kind, fault.step);
    }
    for line in &outcome.logs {
        outln!("log    {line}");
    }
    outln!("");
    let measured: Vec<_> =
        outcome.metrics.iter().filter_map(|(metric, it)| Some((metric, it.value()?))).collect();
    let width = measured.iter().map(|(metric, _)| metric.name().len()).max().unwrap_or(0);
    for (metric, value) in measured {
        outln!("{:<width$} {:>14} {}", metric.name(), Shown(value), metric.unit());
    }
    outln!("");
    let (steps, simulated_s, wall_s) = (summary.steps, summary.simulated_s, summary.wall_s);
    let what = if summary.mode.is_hil() { "the plant" } else { "the drive" };
    let steps = counted(steps, "step");
    outln!("run         {steps}, {simulated_s:.3} s of {what} in {wall_s:.3} s");
    if let Some(CapturedRows { rows, event, .. }) = &outcome.scope {
        outln!("scope       {} rows, the event at row {event}", rows.len());
    }
    outln!("device      {}", summary.device);
    if !summary.mode.is_hil() {
        outln!("mode        bench: positions from the drive's encoders, no truth");
    }
    let is_clean = LinkCounts { frames_sent: 0, frames_received: 0, ..summary.link } == LinkCounts::default();
    if has_details || !is_clean {
        link(&summary.link);
    }
    // In real time it says how far the run is to be trusted.
    if has_details || summary.timing.clock == ClockName::RealTime {
        for (row, line) in summary.timing.to_string().lines().enumerate() {
            outln!("{:<12}{line}", if row == 0 { "timing" } else { "" });
        }
    }
    if has_details {
        details(summary, outcome);
    }
}

fn link(counts: &LinkCounts) {
    let LinkCounts {
        frames_sent,
        frames_received,
        crc_errors,
        lost,
        late,
        resumes,
        damaged_at_drive,
        overruns_at_drive,
    } = *counts;
    outln!(
        "link        {frames_sent} frames out, {frames_received} in; {lost} answers lost, {late} late; {resumes} times resumed"
    );
    outln!(
        "damage      {crc_errors} frames here; {damaged_at_drive} frames, {overruns_at_drive} bytes at the drive"
    );
}

fn details(summary: &Summary, outcome: &Outcome) {
    outln!("controller  {}", summary.controller);
    let Telemetry { every_steps, signals } = &summary.telemetry;
    match signals.len() {
        0 => outln!("telemetry   none"),
        count => outln!("telemetry   {count} signals every {every_steps} steps"),
    }
    outln!("torque      sha256 {}", summary.torque_sha256);
    for (metric, it) in outcome.metrics.iter().filter(|(_, it)| it.value().is_none()) {
        outln!("no value    {}: {it}", metric.name());
    }
}
