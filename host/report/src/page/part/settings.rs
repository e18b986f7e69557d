//! What was set for several runs, and what differs.

use maud::{Markup, html};

use super::super::input::Run;
use super::origin::in_force;

/// Name of a fact, and its value in a run.
type Fact = (String, String);

pub(in super::super) fn section(runs: &[Run]) -> Markup {
    let facts: Vec<_> = runs.iter().map(facts).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in facts.iter().flatten() {
        if !names.contains(&&**name) {
            names.push(name);
        }
    }
    let value = |facts: &'_ [Fact], name: &str| facts.iter().find(|it| it.0 == name).map(|it| it.1.clone());
    let rows =
        names.into_iter().map(|name| (name, facts.iter().map(|it| value(it, name)).collect::<Vec<_>>()));
    let (same, different): (Vec<_>, Vec<_>) =
        rows.partition(|(_, values)| values.iter().all(|it| *it == values[0]));
    html! {
        section #settings {
            h2 { "What differs" }
            @if different.is_empty() { p { "Nothing that the records name." } } @else {
                div.scroll { table.settings {
                    thead { tr { th scope="col" { "fact" } @for run in runs { th scope="col" { (run.name) } } } }
                    tbody { @for (name, values) in different { tr {
                        th scope="row" { (name) }
                        @for value in values { td { @match value { Some(value) => code { (value) }, None => span.absent { "not recorded" } } } }
                    } } }
                } }
            }
            @if !same.is_empty() {
                details {
                    summary { (same.len()) " facts are equal" }
                    p.note { @for (at, (name, values)) in same.iter().enumerate() {
                        @if at > 0 { ", " } (name) " " @if let Some(value) = &values[0] { code { (value) } }
                    } "." }
                }
            }
        }
    }
}

/// The facts of a run, from its manifest as far as it has one.
fn facts(run: &Run) -> Vec<Fact> {
    let mut facts: Vec<(&str, String)> = Vec::new();
    if let Some(it) = &run.summary {
        facts.extend([
            ("scenario", it.scenario.clone()),
            ("device", it.device.clone()),
            ("law", it.controller.clone()),
            ("seed", it.seed.map_or_else(String::new, |seed| seed.to_string())),
            ("clock", it.timing.clock.clone()),
            ("period in us", it.timing.period_us.to_string()),
            ("steps", it.steps.to_string()),
            ("bench", it.evidence.bench_build.clone()),
            ("digest of all torques", it.torque_sha256.clone().unwrap_or_default()),
        ]);
    }
    let mut facts: Vec<Fact> = facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    if let Some(it) = &run.record.manifest {
        facts.extend(it.overrides.iter().map(|set| (format!("set {}", set.key), set.value.clone())));
        facts.extend(it.parameters.iter().map(|it| (format!("parameter {}", it.name), in_force(it))));
        facts.push(("kernel".to_owned(), it.host.kernel.clone()));
        facts.extend(it.host.cpu.iter().map(|cpu| ("processor".to_owned(), cpu.clone())));
    }
    facts
}
