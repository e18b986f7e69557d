//! The report of a run on standard output; the verdict is its last line.

use lashloop_bench::record::summary::Summary;
use lashloop_bench::run::{End, Outcome};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::LinkCounts;

use super::output::outln;

pub(super) fn print(scenario: &Scenario, summary: &Summary, outcome: &Outcome) {
    outln!("{}", scenario.title);
    outln!("device      {}", summary.device);
    outln!("controller  {}", summary.controller);
    let (steps, simulated_s, wall_s) = (summary.steps, summary.simulated_s, summary.wall_s);
    outln!("run         {steps} steps, {simulated_s:.3} s of the plant in {wall_s:.3} s");
    let LinkCounts {
        frames_sent,
        frames_received,
        crc_errors,
        lost,
        late,
        resumes,
        damaged_at_drive,
        overruns_at_drive,
    } = summary.link;
    outln!(
        "link        {frames_sent} frames out, {frames_received} in; {lost} answers lost, {late} late; {resumes} times resumed"
    );
    outln!(
        "damage      {crc_errors} frames here; {damaged_at_drive} frames, {overruns_at_drive} bytes at the drive"
    );
    for (row, line) in summary.timing.to_string().lines().enumerate() {
        outln!("{:<12}{line}", if row == 0 { "timing" } else { "" });
    }
    for fault in &summary.faults {
        let until = fault.until_step.map_or_else(|| "the end".to_owned(), |step| format!("step {step}"));
        let frames = fault.frames.map_or_else(String::new, |frames| format!(", {frames} frames hit"));
        outln!("fault       {} from step {} to {until}{frames}", fault.kind, fault.step);
    }
    outln!("torque      sha256 {}", summary.torque_sha256);
    for line in &outcome.logs {
        outln!("drive log   {line}");
    }
    outln!("");
    for (metric, value) in summary.metrics.iter() {
        let unit = if value.value().is_some() { metric.unit() } else { "" };
        let value = value.value().map_or_else(|| value.to_string(), |number| format!("{number:.4}"));
        outln!("{:<26} {value:>14} {unit}", metric.name());
    }
    outln!("");
    for finding in &summary.expectations {
        outln!("{} {finding}", if finding.ok { "ok    " } else { "MISSED" });
    }
    for breach in &outcome.judgement.breaches {
        outln!("BROKEN {breach}");
    }
    if outcome.end != End::Complete {
        outln!("ENDED  {}", outcome.end);
    }
    outln!("{}", summary.verdict);
}
