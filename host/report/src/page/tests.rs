//! Pages of made-up records: text of others, size, suites.

use std::fs;

use lashloop_bench::fault::timeline::FaultRecord;
use lashloop_bench::verdict::{Breach, JudgedExpectation, Verdict};
use lashloop_plant::Signal;
use lashloop_plant::metrics::{Measured, Metric, Quantity, SignalTable, Statistic};
use lashloop_record::columns::Columns;
use lashloop_record::diff::{Group, Setting};
use lashloop_record::reader::{ReadError, ReadFault, Record};
use lashloop_record::row::Row;
use lashloop_record::samples::{SampleWriter, StepTimes};
use lashloop_record::summary::{RunEnd, Summary};
use lashloop_record::timing::TimingRow;
use serde_json::Value;

use crate::runs::{Input, Selection, figure};

use lashloop_campaign::suite::check::Check;

use super::{Panels, Run, Suite, SuiteRow, suite};

const HOSTILE: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&";
const MANIFEST: &str = include_str!("../../../record/src/manifest/pinned.json");
const SUMMARY: &str = include_str!("../../../record/src/summary/pinned.json");

fn run(run: &Run) -> String {
    super::run(run, &Panels::default())
}

fn comparison(runs: &[Run], settings: &[Setting]) -> String {
    super::comparison(runs, settings, &Panels::default())
}

/// Replaces every text but those that are choices.
fn replace_texts(value: &mut Value, text: &str) {
    const CHOICES: [&str; 5] = ["mode", "clock", "verdict", "metric", "statistic"];
    match value {
        Value::String(old) => text.clone_into(old),
        Value::Array(items) => items.iter_mut().for_each(|it| replace_texts(it, text)),
        Value::Object(entries) => {
            let entries = entries.iter_mut().filter(|(key, _)| !CHOICES.contains(&&***key));
            entries.for_each(|(_, it)| replace_texts(it, text));
        }
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

/// The content of a file with `text` for its texts.
fn of<T: serde::de::DeserializeOwned>(file: &str, text: &str) -> T {
    let mut value = serde_json::from_str(file).expect("JSON");
    replace_texts(&mut value, text);
    serde_json::from_value(value).expect("its type")
}

/// A record whose texts are `text`, with `columns` columns of noise in every step from `first` on.
pub(super) fn record(text: &str, first: usize, steps: usize, columns: usize) -> Record {
    let fixed =
        [("time_s", "s"), ("reference_rad", "rad"), ("load_position_rad", "rad"), ("torque_nm", "N m")];
    let noise = (0..columns)
        .map(|column| Signal { name: format!("drive.noise_{column}").into(), unit: text.to_owned().into() });
    let mut trace =
        Columns::new(fixed.map(|(name, unit)| Signal::new(name, unit)).into_iter().chain(noise).collect());
    let mut noise = 1_u64;
    for step in first..first + steps {
        let time_s = step as f64 * 1e-3;
        let noise = (0..columns).map(|_| {
            noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (noise >> 33) as f64
        });
        trace.push([time_s, 0.0, time_s.cos(), 1.5].into_iter().chain(noise));
    }
    let mut summary: Summary = of(SUMMARY, text);
    summary.end = RunEnd::Complete;
    summary.metrics.insert(text.to_owned(), Some(1.0));
    summary.faults = vec![fault(text, 1)];
    Record {
        folder: "made-up".into(),
        manifest: of(MANIFEST, text),
        trace,
        timing: timing(&[]),
        faults: Vec::new(),
        logs: Vec::new(),
        is_torn: false,
        summary: Some(summary),
        failure: None,
    }
}

fn fault(kind: &str, step: u32) -> FaultRecord {
    FaultRecord { kind: kind.to_owned().into(), step, until_step: None, frames: Some(3) }
}

/// The columns of the timing, of rows without their step.
fn timing(rows: &[[f64; 7]]) -> Columns {
    let columns = TimingRow::COLUMNS.iter().map(|(name, unit)| Signal::new(name, unit));
    let mut timing = Columns::new(columns.collect());
    for (step, row) in rows.iter().enumerate() {
        timing.push([step as f64].into_iter().chain(*row));
    }
    timing
}

fn made_up(text: &str, steps: usize, columns: usize) -> Run {
    Run::new(text, record(text, 0, steps, columns))
}

fn hostile_setting() -> Setting {
    let text = HOSTILE.to_owned();
    Setting { group: Group::Scenario, key: text.clone(), values: vec![Some(text), None] }
}

fn hostile_suite() -> Suite {
    let text = HOSTILE.to_owned();
    let check = |value, ok| Check {
        name: text.clone(),
        value: Some(value),
        min: None,
        max: Some(2.0),
        unit: text.clone(),
        ok,
    };
    let row = |verdict: &str, check| SuiteRow {
        name: text.clone(),
        settings: vec![(text.clone(), text.clone())],
        device: text.clone(),
        verdict: verdict.to_owned(),
        reason: text.clone(),
        checks: vec![check],
        wall_s: 0.5,
        report: Some("javascript:alert(3)".to_owned()),
    };
    Suite {
        title: text.clone(),
        verdict: text.clone(),
        reason: Some(text.clone()),
        command: vec![text.clone()],
        wall_s: 1.0,
        rows: vec![
            row("PASS", check(1.0, true)),
            row("PASS", check(1.9, true)),
            row("FAIL", check(2.5, false)),
        ],
    }
}

#[test]
fn text_of_others_is_never_markup() {
    let one = made_up(HOSTILE, 10, 1);
    let both = [one.clone(), one.clone()];
    for page in [run(&one), comparison(&both, &[hostile_setting()]), suite(&hostile_suite())] {
        assert!(page.contains("&lt;img src=x"), "the text is shown");
        assert!(!page.contains("<img"), "no element of the text");
        assert_eq!(page.matches("<script").count(), 2, "the data and the script");
        assert!(!page.contains("alert(1)</script"), "no end of a script");
        assert!(!page.contains("href=\"javascript:"), "no script as an address");
    }
}

#[test]
fn a_page_refers_to_nothing_outside_itself() {
    let one = made_up("plain", 10, 1);
    for page in [run(&one), comparison(&[one.clone(), one.clone()], &[]), suite(&Suite::default())] {
        for outside in ["http://", "https://", " src=", "@import", "import("] {
            let found = page.find(outside).map(|at| &page[at.saturating_sub(40)..(at + 40).min(page.len())]);
            // The name space of drawings is an identifier, not an address that is loaded.
            assert!(found.is_none_or(|text| text.contains("www.w3.org/2000/svg")), "{outside}: {found:?}");
        }
        assert!(
            page.match_indices("url(").all(|(at, _)| page[at..].starts_with("url(#")),
            "addresses inside the page alone"
        );
    }
}

#[test]
fn columns_of_pure_noise_are_rounded_until_the_page_is_small() {
    let page = run(&made_up("plain", 25_000, 30));
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    assert!(page.contains("rounded to 1/4096 of"), "coarser than a quiet run");
}

#[test]
fn a_suite_counts_passes_with_a_small_margin_apart() {
    let page = suite(&Suite { title: "nightly".to_owned(), reason: None, ..hostile_suite() });
    let rows: Vec<_> =
        page.match_indices("<tr data-tone=").map(|(at, _)| page[at + 15..].split('"').next()).collect();
    assert_eq!(rows, [Some("pass"), Some("marginal"), Some("fail")]);
    assert!(page.contains("2 of 3 cases passed in 1.0 s."));
}

#[test]
fn the_badge_of_a_suite_is_its_verdict_and_not_that_of_its_rows() {
    for (verdict, badge) in [
        ("PASS", "verdict marginal\"><p class=\"badge\">PASS<small>marginal</small></p>"),
        ("FAIL", "verdict fail\"><p class=\"badge\">FAIL</p>"),
        ("INVALID", "verdict invalid\"><p class=\"badge\">INVALID</p>"),
        ("ERROR", "verdict fail\"><p class=\"badge\">ERROR</p>"),
        ("INCOMPLETE", "verdict none\"><p class=\"badge\">INCOMPLETE</p>"),
        ("NO VERDICT", "verdict none\"><p class=\"badge\">NO VERDICT</p>"),
    ] {
        let page =
            suite(&Suite { verdict: verdict.to_owned(), title: "nightly".to_owned(), ..hostile_suite() });
        assert!(page.contains(badge), "{badge}");
        assert!(page.contains(&format!("<title>{verdict}: nightly</title>")), "{verdict}");
    }
}

/// A plain PASS without an expectation and a fault.
fn pass() -> Summary {
    Summary {
        verdict: Verdict::Pass,
        end: RunEnd::Complete,
        expectations: Vec::new(),
        faults: Vec::new(),
        ..of(SUMMARY, "plain")
    }
}

/// The page of a run with this summary.
fn page_of(summary: Summary) -> String {
    run(&Run::new("plain", Record { summary: Some(summary), ..record("plain", 0, 10, 1) }))
}

fn judged(quantity: Quantity, value: f64, min: Option<f64>, max: f64) -> JudgedExpectation {
    JudgedExpectation {
        quantity,
        window: None,
        value: Measured::Value(value),
        reason: None,
        unit: "rad".to_owned(),
        min,
        max: Some(max),
        ok: value <= max,
    }
}

#[test]
fn the_sentence_states_why_the_verdict_is_what_it_is() {
    let limits = |values: [f64; 2]| {
        values.map(|value| judged(Quantity::Metric(Metric::StaticError), value, None, 2.0)).into()
    };
    for (summary, sentence) in [
        (pass(), "Nothing was expected: the scenario has no expectation. Every value of the run is finite."),
        (
            Summary { expectations: limits([1.0, 1.9]), ..pass() },
            "All 2 expectations are met, 1 of them marginally; the smallest margin is 5.0\u{202f}% of static_error_rad.",
        ),
        (
            Summary { verdict: Verdict::Fail, expectations: limits([1.0, 2.000_000_1]), ..pass() },
            "static_error_rad is 2.0000001 rad, above the limit of 2 rad.",
        ),
        (
            Summary {
                verdict: Verdict::Invalid,
                breaches: vec![Breach { what: "late".into(), counted: Some(312), allowed: 0 }],
                ..pass()
            },
            "late is 312, allow.late is 0: the run proves nothing about the drive.",
        ),
        (
            Summary {
                verdict: Verdict::Fail,
                end: RunEnd::Early("the drive latched X".to_owned()),
                simulated_s: 1.5,
                ..pass()
            },
            "The run ended at 1.500 s: the drive latched X.",
        ),
    ] {
        let page = page_of(summary);
        assert!(
            page.contains(sentence),
            "{sentence}\n{:?}",
            page.find("class=\"why\"").map(|at| &page[at..at + 200])
        );
    }
}

#[test]
fn an_exact_expectation_has_no_gauge_and_no_nan() {
    let contacts = Quantity::Statistic { signal: "contacts".to_owned(), statistic: Statistic::Final };
    let page = page_of(Summary { expectations: vec![judged(contacts, 3.0, Some(3.0), 3.0)], ..pass() });
    assert!(!page.contains("=\"NaN\"") && page.contains("contacts"));
}

#[test]
fn faults_are_marked_at_their_time_in_a_record_that_begins_later() {
    let faults = [3, 1999, 2003, 2009, 2010].map(|step| fault(&format!("at-{step}"), step));
    let summary = Some(Summary { faults: faults.into(), ..pass() });
    let window = Record { summary, ..record("plain", 2000, 10, 0) };
    let page = run(&Run::new("window", window.clone()));
    let marks = r#""marks":[{"x":2.003,"label":"at-2003"},{"x":2.009,"label":"at-2009"}]"#;
    assert!(page.contains(marks), "{:?}", page.find("\"marks\":[{").map(|at| &page[at..at + 120]));

    let selection = Selection { shown_s: 2.002..=2.01, signals: Vec::new(), panels: Vec::new() };
    let figure =
        figure(&[("window".to_owned(), Input::Record(Box::new(window)))], &selection).expect("a figure");
    let marks: Vec<_> = figure.panels[0].marks.iter().map(|mark| (&*mark.label, mark.x, mark.y)).collect();
    assert_eq!(marks, [("at-2003", 2.003, 2.003_f64.cos()), ("at-2009", 2.009, 2.009_f64.cos())]);
}

/// Steps of the table of the worst steps.
fn worst(rows: &[[f64; 7]]) -> Vec<String> {
    let timed = Record { timing: timing(rows), ..record("plain", 0, rows.len(), 1) };
    let page = run(&Run::new("plain", timed));
    let (_, table) = page.split_once("table class=\"worst\"").expect("a table");
    let (table, _) = table.split_once("</table>").expect("its end");
    let step = |row: &str| {
        row.split_once("<td class=\"number\">")?.1.split_once('<').map(|(step, _)| step.to_owned())
    };
    table.split("<tr>").filter_map(step).collect()
}

const NAN: f64 = f64::NAN;

#[test]
fn worst_steps_without_a_round_trip_are_those_of_the_largest_lateness() {
    let row = |lateness_us, compute_us| [lateness_us, 1.0, 0.0, NAN, NAN, compute_us, NAN];
    let bench_mode = [row(5.0, 2.0), row(50.0, 2.0), row(20.0, 2.0), row(50.0, 9.0)];
    assert_eq!(worst(&bench_mode), ["3", "1", "2", "0"]);
}

#[test]
fn a_step_without_a_torque_is_worse_than_one_whose_round_trip_is_unknown() {
    let retransmitted = [
        [5.0, 1.0, 0.0, NAN, NAN, NAN, NAN],
        [0.0, 1.0, 0.0, 100.0, 100.0, 100.0, 100.0],
        [0.0, 0.0, 0.0, NAN, NAN, NAN, NAN],
        [0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0],
    ];
    assert_eq!(worst(&retransmitted), ["2", "1", "0", "3"]);
}

#[test]
fn a_run_without_a_step_has_a_page_with_its_verdict() {
    let ended = Summary {
        verdict: Verdict::Fail,
        end: RunEnd::Early("the drive latched X".to_owned()),
        simulated_s: 0.0,
        ..pass()
    };
    let page = run(&Run::new("plain", Record { summary: Some(ended), ..record("plain", 0, 0, 1) }));
    assert!(page.contains("The run ended at 0.000 s: the drive latched X."));
    assert!(!page.contains("<figure data-chart") && page.contains("id=\"data\">null<"), "no charts");

    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("record.json"), MANIFEST).expect("a manifest");
    let times = StepTimes { start_ns: 0, period_us: 1000 };
    let samples = SampleWriter::create(folder.path(), &SignalTable::default(), times, 0, 1, &[]);
    samples.and_then(|samples| samples.finish(("summary.json", "{}"))).expect("samples");
    let error = Run::read("plain", folder.path()).expect_err("neither rows nor a summary");
    assert!(matches!(error, ReadError { fault: ReadFault::Empty, .. }), "{error}");
}
