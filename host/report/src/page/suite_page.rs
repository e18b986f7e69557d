//! The index page of a suite of runs.

use maud::{Markup, html};

use super::margin::{Grade, MARGINAL, Margin};
use super::part::command::copied;
use super::shell::document;
use super::typeset::{apart, percent, shown, unit};
use super::why::Tone;

/// A suite: one row for each run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Suite {
    /// Title of the page.
    pub title: String,
    /// The command that made it.
    pub command: String,
    /// Wall-clock time of the whole suite, in s.
    pub wall_s: f64,
    /// The runs, in their order.
    pub rows: Vec<SuiteRow>,
}

/// One run of a suite.
#[derive(Debug, Clone, PartialEq)]
pub struct SuiteRow {
    /// Name of the scenario, with its case in a sweep.
    pub name: String,
    /// What this case sets, as key and value.
    pub settings: Vec<(String, String)>,
    /// The device.
    pub device: String,
    /// PASS, FAIL or INVALID; `None` if there is no verdict.
    pub verdict: Option<String>,
    /// Why, in one sentence.
    pub reason: String,
    /// The expectations.
    pub expectations: Vec<SuiteExpectation>,
    /// Wall-clock time, in s.
    pub wall_s: f64,
    /// Relative address of the run's report, if it was kept.
    pub report: Option<String>,
}

/// One expectation of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct SuiteExpectation {
    /// What is judged.
    pub name: String,
    /// Its value; `None` without one.
    pub value: Option<f64>,
    /// Smallest value that passes.
    pub min: Option<f64>,
    /// Largest value that passes.
    pub max: Option<f64>,
    /// The unit.
    pub unit: String,
    /// Whether it is met.
    pub ok: bool,
}

impl SuiteExpectation {
    fn fraction(&self) -> Option<f64> {
        Margin::of(self.value?, self.min, self.max)?.fraction
    }

    fn grade(&self) -> Grade {
        match self.fraction() {
            _ if !self.ok => Grade::Fail,
            Some(fraction) if fraction < MARGINAL => Grade::Marginal,
            _ => Grade::Pass,
        }
    }
}

impl SuiteRow {
    fn tone(&self) -> Tone {
        match Tone::of_verdict(self.verdict.as_deref().unwrap_or_default()) {
            Tone::Pass if self.expectations.iter().any(|it| it.grade() == Grade::Marginal) => Tone::Marginal,
            tone => tone,
        }
    }

    /// The expectation with the smallest margin.
    fn tightest(&self) -> Option<(&SuiteExpectation, f64)> {
        let margins = self.expectations.iter().filter_map(|it| Some((it, it.fraction()?)));
        margins.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }
}

/// An index of the runs as a self-contained HTML document.
#[must_use]
pub fn suite(suite: &Suite) -> String {
    let tones = [Tone::Pass, Tone::Marginal, Tone::Fail, Tone::Invalid, Tone::None];
    let count = |tone| suite.rows.iter().filter(|row| row.tone() == tone).count();
    let is_good = suite.rows.iter().all(|row| matches!(row.tone(), Tone::Pass | Tone::Marginal));
    let verdict = if is_good { "PASS" } else { "FAIL" };
    let passed = count(Tone::Pass) + count(Tone::Marginal);
    let content = html! {
        section class={ "verdict " (if is_good { "pass" } else { "fail" }) } {
            p.badge { (verdict) }
            div {
                h1 { (suite.title) }
                p.why { (passed) " of " (suite.rows.len()) " runs passed in " (format!("{:.1}", suite.wall_s)) " s." }
            }
        }
        section #runs {
            h2 { "Runs" }
            div.filters role="group" aria-label="Verdicts shown" hidden {
                @for tone in tones { @if count(tone) > 0 {
                    button type="button" aria-pressed="true" data-filter=(tone.class()) { span class={ "grade " (tone.class()) } { (name(tone)) } " " (count(tone)) }
                } }
            }
            div.scroll { table.suite.stacked {
                thead { tr {
                    @for name in ["verdict", "run", "why", "smallest margin"] { th scope="col" { (name) } }
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
        &[("runs", "Runs"), ("repeat", "Run it again")],
        None,
        &content,
    )
}

fn name(tone: Tone) -> &'static str {
    match tone {
        Tone::Pass => "PASS",
        Tone::Marginal => "marginal",
        Tone::Fail => "FAIL",
        Tone::Invalid => "INVALID",
        Tone::None => "no verdict",
    }
}

fn row(row: &SuiteRow) -> Markup {
    let tone = row.tone();
    let settings =
        row.settings.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ");
    html! {
        tr data-tone=(tone.class()) {
            td { span class={ "grade " (tone.class()) } { (name(tone)) } }
            th scope="row" {
                @match row.report.as_deref().filter(|address| is_relative(address)) { Some(address) => a href=(address) { (row.name) }, None => (row.name) }
                @if !settings.is_empty() { br; small { code { (settings) } } }
                br; small { (row.device) }
            }
            td.meaning { (row.reason) }
            td.meaning { @if let Some((it, fraction)) = row.tightest() {
                strong { (percent(fraction)) } " " (it.name) ": "
                @if let Some(value) = it.value { (apart(value, it.min, it.max)) " " (unit(&it.unit)) }
                @if let Some(min) = it.min { ", \u{2265} " (shown(min)) }
                @if let Some(max) = it.max { ", \u{2264} " (shown(max)) }
            } }
            td.number { (format!("{:.2}", row.wall_s)) }
        }
    }
}

/// Whether an address leads to a file next to the page: no script and no network.
fn is_relative(address: &str) -> bool {
    let first = address.split('/').next().unwrap_or_default();
    !first.contains(':') && !address.starts_with('/')
}
