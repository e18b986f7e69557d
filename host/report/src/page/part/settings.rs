//! What was set differently in several runs.

use lashloop_record::diff::Setting;
use maud::{Markup, html};

use super::super::input::Run;

/// Settings have a value for each of the runs.
pub(in super::super) fn section(runs: &[Run], settings: &[Setting]) -> Markup {
    let (same, different): (Vec<_>, Vec<_>) = settings.iter().partition(|it| it.is_same());
    html! {
        section #settings {
            h2 { "Set differently" }
            @if different.is_empty() { p { "Nothing: scenario, parameters, drive, bench and host are the same." } } @else {
                div.scroll { table.settings {
                    thead { tr { th scope="col" { "group" } th scope="col" { "key" } @for run in runs { th scope="col" { (run.name) } } } }
                    tbody { @for it in different { tr {
                        td { (it.group) }
                        th scope="row" { code { (it.key) } }
                        @for value in &it.values { td { @match value { Some(value) => code { (value) }, None => span.absent { "not set" } } } }
                    } } }
                } }
            }
            @if !same.is_empty() {
                details {
                    summary { (same.len()) " settings are the same" }
                    p.note { @for (at, it) in same.iter().enumerate() {
                        @if at > 0 { ", " } (it.key) " " @if let Some(value) = &it.values[0] { code { (value) } }
                    } "." }
                }
            }
        }
    }
}
