//! The index page of a suite of cases.

use lashloop_campaign::suite::check::Check;
use lashloop_session::counted;
use maud::{Markup, html};

use super::margin::Margin;
use super::part::command::copied;
use super::shell::document;
use super::typeset::{apart, percent, shown, unit};
use super::why::Tone;

/// A suite: one row for each case, also for a case without a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Suite {
    /// Title of the page.
    pub title: String,
    /// The worst verdict of a case, or INCOMPLETE or NO VERDICT if the cases that ran don't judge the suite.
    pub verdict: String,
    /// Why there is no verdict, in one sentence.
    pub reason: Option<String>,
    /// The words of the command that made it.
    pub command: Vec<String>,
    /// Wall-clock time of the whole suite, in s.
    pub wall_s: f64,
    /// The cases, in their order.
    pub rows: Vec<SuiteRow>,
}

/// One case of a suite.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SuiteRow {
    /// Name of the scenario.
    pub name: String,
    /// What this case sets, as key and value.
    pub settings: Vec<(String, String)>,
    /// The device; empty for a case without a run.
    pub device: String,
    /// PASS, FAIL, INVALID, ERROR, SKIPPED or NOT RUN.
    pub verdict: String,
    /// Why, in one sentence.
    pub reason: String,
    /// The expectations, and the metrics against their baseline.
    pub checks: Vec<Check>,
    /// Wall-clock time, in s.
    pub wall_s: f64,
    /// Relative address of the run's report, if it was kept.
    pub report: Option<String>,
}

/// Results in the order of the filters.
const LABELS: [&str; 7] = ["PASS", MARGINAL, "FAIL", "INVALID", "ERROR", "SKIPPED", "NOT RUN"];
/// PASS with a marginal check.
const MARGINAL: &str = "marginal";

impl SuiteRow {
    fn label(&self) -> &str {
        let is_marginal = || self.checks.iter().any(|it| Tone::of_check(it) == Tone::Marginal);
        if self.verdict == "PASS" && is_marginal() { MARGINAL } else { &self.verdict }
    }

    /// The check with the smallest margin.
    fn tightest(&self) -> Option<(&Check, f64)> {
        let margins = self.checks.iter().filter_map(|it| Some((it, Margin::of_check(it)?.fraction?)));
        margins.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }
}

fn tone(label: &str) -> Tone {
    match label {
        "PASS" => Tone::Pass,
        MARGINAL => Tone::Marginal,
        "FAIL" | "ERROR" => Tone::Fail,
        "INVALID" => Tone::Invalid,
        _ => Tone::None,
    }
}

/// Name of a label in attributes.
fn key(label: &str) -> String {
    label.to_lowercase().replace(' ', "-")
}

/// An index of the cases as a self-contained HTML document.
#[must_use]
pub fn suite(suite: &Suite) -> String {
    let count = |label: &str| suite.rows.iter().filter(|row| row.label() == label).count();
    let (verdict, has_marginal) = (&*suite.verdict, count(MARGINAL) > 0);
    let tone_of_all = if verdict == "PASS" && has_marginal { Tone::Marginal } else { tone(verdict) };
    let content = html! {
        section class={ "verdict " (tone_of_all.class()) } {
            p.badge { (verdict) @if tone_of_all == Tone::Marginal { small { (MARGINAL) } } }
            div {
                h1 { (suite.title) }
                p.why {
                    (count("PASS") + count(MARGINAL)) " of " (counted(suite.rows.len() as u64, "case")) " passed in " (format!("{:.1}", suite.wall_s)) " s."
                    @if let Some(reason) = &suite.reason { " " (reason) }
                }
            }
        }
        section #cases {
            h2 { "Cases" }
            div.filters role="group" aria-label="Verdicts shown" hidden {
                @for label in LABELS { @if count(label) > 0 {
                    button type="button" aria-pressed="true" data-filter=(key(label)) { span class={ "grade " (tone(label).class()) } { (label) } " " (count(label)) }
                } }
            }
            div.scroll { table.suite.stacked {
                thead { tr {
                    @for name in ["verdict", "case", "why", "smallest margin"] { th scope="col" { (name) } }
                    th.number scope="col" { "time in s" }
                } }
                tbody { @for it in &suite.rows { (row(it)) } }
            } }
        }
        section #repeat {
            h2 { "Run it again" }
            (copied(&suite.command))
        }
    };
    document(
        &format!("{verdict}: {}", suite.title),
        &[("cases", "Cases"), ("repeat", "Run it again")],
        None,
        &content,
    )
}

fn row(row: &SuiteRow) -> Markup {
    let label = row.label();
    let settings =
        row.settings.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ");
    html! {
        tr data-tone=(key(label)) {
            td { span class={ "grade " (tone(label).class()) } { (label) } }
            th scope="row" {
                @match row.report.as_deref().filter(|address| is_relative(address)) { Some(address) => a href=(address) { (row.name) }, None => (row.name) }
                @if !settings.is_empty() { br; small { code { (settings) } } }
                @if !row.device.is_empty() { br; small { (row.device) } }
            }
            td.meaning { (row.reason) }
            td.meaning { @if let Some((it, fraction)) = row.tightest() {
                strong { (percent(fraction)) } " " (it.name) ": "
                @if let Some(value) = it.value { (apart(value, it.min, it.max)) " " (unit(&it.unit)) }
                @if let Some(min) = it.min { ", \u{2265} " (shown(min)) }
                @if let Some(max) = it.max { ", \u{2264} " (shown(max)) }
            } }
            // A case without a run took no time.
            td.number { @if row.wall_s > 0.0 { (format!("{:.2}", row.wall_s)) } }
        }
    }
}

/// Whether an address leads to a file next to the page: no script and no network.
fn is_relative(address: &str) -> bool {
    let first = address.split('/').next().unwrap_or_default();
    !first.contains(':') && !address.starts_with('/')
}
