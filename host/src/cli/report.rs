//! A run on the terminal: who, what, how well, and the verdict last.

use lashloop_bench::record::summary::Summary;
use lashloop_bench::run::{End, Outcome};
use lashloop_bench::scenario::Scenario;
use lashloop_bench::verdict::LinkCounts;

pub(super) fn print(scenario: &Scenario, summary: &Summary, outcome: &Outcome) {
    say!("{}", scenario.title);
    say!("device      {}", summary.device);
    say!("controller  {}", summary.controller);
    let (steps, simulated_s, wall_s) = (summary.steps, summary.simulated_s, summary.wall_s);
    say!("run         {steps} steps, {simulated_s:.3} s of the plant in {wall_s:.3} s");
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
    say!(
        "link        {frames_sent} frames out, {frames_received} in; {lost} answers lost, {late} late; {resumes} times resumed"
    );
    say!(
        "damage      {crc_errors} frames here; {damaged_at_drive} frames, {overruns_at_drive} bytes at the drive"
    );
    for (row, line) in summary.timing.to_string().lines().enumerate() {
        say!("{:<12}{line}", if row == 0 { "timing" } else { "" });
    }
    for fault in &summary.faults {
        let until = fault.until_step.map_or_else(|| "the end".to_owned(), |step| format!("step {step}"));
        let frames = fault.frames.map_or_else(String::new, |frames| format!(", {frames} frames hit"));
        say!("fault       {} from step {} to {until}{frames}", fault.kind, fault.step);
    }
    say!("torque      sha256 {}", summary.torque_sha256);
    for line in &outcome.logs {
        say!("drive says  {line}");
    }
    say!("");
    for (metric, value) in summary.metrics.iter() {
        let unit = if value.value().is_some() { metric.unit() } else { "" };
        let value = value.value().map_or_else(|| value.to_string(), |number| format!("{number:.4}"));
        say!("{:<26} {value:>14} {unit}", metric.name());
    }
    say!("");
    for finding in &summary.expectations {
        say!("{} {finding}", if finding.ok { "ok    " } else { "MISSED" });
    }
    for breach in &outcome.judgement.breaches {
        say!("BROKEN {breach}");
    }
    if outcome.end != End::Complete {
        say!("ENDED  {}", outcome.end);
    }
    say!("{}", summary.verdict);
}
