//! What was run, and how to run it again.

use maud::{Markup, html};

use super::super::input::Run;
use super::super::summary::Summary;

pub(in super::super) fn section(run: &Run) -> Markup {
    html! {
        section #origin {
            h2 { "What was run" }
            @match &run.summary {
                Some(summary) => (summary_rows(summary)),
                None => p { "The record has no summary, so scenario and device are unknown." },
            }
        }
    }
}

fn summary_rows(summary: &Summary) -> Markup {
    html! {
        dl.origin {
            dt { "scenario" } dd { code { (summary.scenario) } }
            dt { "device" } dd { (summary.device) }
            @if let Some(mode) = &summary.mode { dt { "mode" } dd { (mode) ": positions from the drive's encoders, no truth" } }
            dt { "law" } dd { code { (summary.controller) } }
            @if let Some(seed) = summary.seed { dt { "seed" } dd { (seed) } }
            @for (name, version) in &summary.versions {
                dt { (name.replace('_', " ")) } dd { (version.as_str().map_or_else(|| version.to_string(), str::to_owned)) }
            }
            @if !summary.evidence.bench_build.is_empty() { dt { "bench" } dd { (summary.evidence.bench_build) } }
            @for file in &summary.evidence.files {
                dt { "file of the drive" } dd { code { (file.path) } br; code.hash { (file.sha256) } }
            }
            @for warning in &summary.evidence.warnings { dt { "warning" } dd.warning { (warning) } }
            @if let Some(digest) = &summary.torque_sha256 { dt { "digest of all torques" } dd { code.hash { (digest) } } }
            @if !summary.link.is_empty() {
                dt { "link" }
                dd { @for (at, (name, count)) in summary.link.iter().enumerate() { @if at > 0 { "; " } (name.replace('_', " ")) " " (count) } }
            }
        }
    }
}

/// The command that repeats the run.
pub(in super::super) fn repeat(run: &Run) -> Markup {
    let Some(summary) = &run.summary else { return html! {} };
    let device = summary.device.split(" (").next().unwrap_or(&summary.device);
    let command = format!(
        "lashloop run {} --device {} --controller {}",
        quoted(&summary.scenario),
        quoted(device),
        quoted(&summary.controller)
    );
    html! {
        section #repeat {
            h2 { "Run it again" }
            (super::command::copied(&command))
            p.note { "This record is of an older format: it lacks the settings of the command line, the parameters in force and the host. \
                      A run with --set needs the same settings again." }
        }
    }
}

/// A word of a shell.
fn quoted(word: &str) -> String {
    let is_plain = |character: char| character.is_ascii_alphanumeric() || "-_./:=,@%+".contains(character);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}
