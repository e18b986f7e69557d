//! Pages of made-up records: text of others, size, suites.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use lashloop_record::diff::{Group, Setting};
use lashloop_record::reader::{ReadError, ReadFault, Record};

use crate::runs::{Input, Selection, figure};

use super::{Check, Run, Suite, SuiteRow, comparison, run, suite};

const HOSTILE: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&";

/// A record whose texts are `text`, with `columns` columns of noise.
fn record(folder: &Path, text: &str, steps: usize, columns: usize) {
    let names: Vec<_> = (0..columns).map(|column| format!("drive.noise_{column}")).collect();
    let mut trace = format!("time_s,reference_rad,load_position_rad,torque_nm,{}\n", names.join(","));
    let mut noise = 1_u64;
    for step in 0..steps {
        write!(trace, "{},0.0,{},1.5", step as f64 * 1e-3, (step as f64 * 1e-3).cos()).expect("a string");
        for _ in 0..columns {
            noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            write!(trace, ",{}", noise >> 33).expect("a string");
        }
        trace.push('\n');
    }
    let units: Vec<_> = names.iter().map(|name| serde_json::json!({ "name": name, "unit": text })).collect();
    let summary = serde_json::json!({
        "verdict": text, "scenario": text, "device": text, "controller": text, "end": "complete",
        "evidence": { "files": [{ "path": text, "sha256": text }], "bench_build": text, "warnings": [text] },
        "metrics": { "static_error_rad": 0.25, text: 1.0 }, "metrics_without_value": { text: text },
        "expectations": [{ "metric": text, "value": 1.0, "unit": text, "min": null, "max": 2.0, "ok": true }],
        "faults": [{ "kind": text, "step": 1, "until_step": null, "frames": 3 }], "torque_sha256": text,
        "versions": { text: text }, "timing": { "clock": text },
    });
    let json = serde_json::json!({ "columns": units });
    for (name, content) in
        [("trace.csv", trace), ("trace.json", json.to_string()), ("summary.json", summary.to_string())]
    {
        fs::write(folder.join(name), content).expect("a file");
    }
}

fn read(text: &str, steps: usize, columns: usize) -> Run {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), text, steps, columns);
    Run::read(text, folder.path()).expect("a record")
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
    let one = read(HOSTILE, 10, 1);
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
    let one = read("plain", 10, 1);
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
    let page = run(&read("plain", 25_000, 30));
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

/// The page of a run with this summary; keys that it lacks are those of a plain one.
fn page_of(summary: &serde_json::Value) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), "plain", 10, 1);
    let mut whole = serde_json::json!({
        "verdict": "PASS", "scenario": "s.toml", "device": "inproc", "controller": "pd", "end": "complete", "faults": [],
    });
    let (Some(whole_keys), Some(keys)) = (whole.as_object_mut(), summary.as_object()) else {
        panic!("two objects")
    };
    whole_keys.extend(keys.clone());
    fs::write(folder.path().join("summary.json"), whole.to_string()).expect("a file");
    run(&Run::read("plain", folder.path()).expect("a record"))
}

#[test]
fn the_sentence_states_why_the_verdict_is_what_it_is() {
    let limit = |value: f64| {
        let ok = value <= 2.0;
        serde_json::json!({ "metric": "static_error_rad", "value": value, "unit": "rad", "min": null, "max": 2.0, "ok": ok })
    };
    for (summary, sentence) in [
        (serde_json::json!({}), "The scenario has no expectation, and every value of the run is finite."),
        (
            serde_json::json!({ "expectations": [limit(1.0), limit(1.9)] }),
            "All 2 expectations are met, 1 of them marginally; the smallest margin is 5.0\u{202f}% of static_error_rad.",
        ),
        (
            serde_json::json!({ "verdict": "FAIL", "expectations": [limit(1.0), limit(2.000_000_1)] }),
            "static_error_rad is 2.0000001 rad, above the limit of 2 rad.",
        ),
        (
            serde_json::json!({ "verdict": "INVALID", "breaches": [{ "what": "late", "counted": 312, "allowed": 0 }] }),
            "late is 312, allow.late is 0: the run proves nothing about the drive.",
        ),
        (
            serde_json::json!({ "verdict": "FAIL", "end": "the drive latched X", "simulated_s": 1.5 }),
            "The run ended at 1.500 s: the drive latched X.",
        ),
    ] {
        let page = page_of(&summary);
        assert!(
            page.contains(sentence),
            "{sentence}\n{:?}",
            page.find("class=\"why\"").map(|at| &page[at..at + 200])
        );
    }
}

#[test]
fn an_exact_expectation_has_no_gauge_and_no_nan() {
    let exact = serde_json::json!({ "metric": "contacts", "value": 3.0, "unit": "", "min": 3.0, "max": 3.0, "ok": true });
    let page = page_of(&serde_json::json!({ "expectations": [exact] }));
    assert!(!page.contains("=\"NaN\"") && page.contains("contacts"));
}

#[test]
fn faults_are_marked_at_their_time_in_a_record_that_begins_later() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), "plain", 10, 1);
    let rows: String =
        (2000..2010).map(|step| format!("{},0.0,{step},1.5\n", f64::from(step) * 1e-3)).collect();
    let trace = format!("time_s,reference_rad,load_position_rad,torque_nm\n{rows}");
    fs::write(folder.path().join("trace.csv"), trace).expect("a file");
    let fault = |step: u32| serde_json::json!({ "kind": format!("at-{step}"), "step": step });
    let faults = [3, 1999, 2003, 2009, 2010].map(fault);
    let summary = serde_json::json!({
        "verdict": "FAIL", "scenario": "s", "device": "d", "controller": "c", "end": "complete", "faults": faults,
    });
    fs::write(folder.path().join("summary.json"), summary.to_string()).expect("a file");
    let page = run(&Run::read("window", folder.path()).expect("a record"));
    let marks = r#""marks":[{"x":2.003,"label":"at-2003"},{"x":2.009,"label":"at-2009"}]"#;
    assert!(page.contains(marks), "{:?}", page.find("\"marks\":[{").map(|at| &page[at..at + 120]));

    let read = Record::read(folder.path()).expect("a record");
    let selection = Selection { shown_s: 2.002..=2.01, signals: Vec::new(), panels: Vec::new() };
    let figure =
        figure(&[("window".to_owned(), Input::Record(Box::new(read)))], &selection).expect("a figure");
    let marks: Vec<_> = figure.panels[0].marks.iter().map(|mark| (&*mark.label, mark.x, mark.y)).collect();
    assert_eq!(marks, [("at-2003", 2.003, 2003.0), ("at-2009", 2.009, 2009.0)]);
}

/// Steps of the table of the worst steps.
fn worst(timing: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), "plain", 4, 1);
    let head = "lateness_us,answered,missed,send_us,line_and_device_us,compute_us,receive_us";
    fs::write(folder.path().join("timing.csv"), format!("{head}\n{timing}")).expect("a file");
    let page = run(&Run::read("plain", folder.path()).expect("a record"));
    let (_, table) = page.split_once("table class=\"worst\"").expect("a table");
    let (table, _) = table.split_once("</table>").expect("its end");
    let step = |row: &str| {
        row.split_once("<td class=\"number\">")?.1.split_once('<').map(|(step, _)| step.to_owned())
    };
    table.split("<tr>").filter_map(step).collect()
}

#[test]
fn worst_steps_without_a_round_trip_are_those_of_the_largest_lateness() {
    let bench_mode = "5,1,0,,,2,\n50,1,0,,,2,\n20,1,0,,,2,\n50,1,0,,,9,\n";
    assert_eq!(worst(bench_mode), ["3", "1", "2", "0"]);
}

#[test]
fn a_step_without_a_torque_is_worse_than_one_whose_round_trip_is_unknown() {
    let retransmitted = "5,1,0,,,,\n0,1,0,100,100,100,100\n0,0,0,,,,\n0,1,0,1,1,1,1\n";
    assert_eq!(worst(retransmitted), ["2", "1", "0", "3"]);
}

#[test]
fn a_run_without_a_step_has_a_page_with_its_verdict() {
    let folder = tempfile::tempdir().expect("a folder");
    record(folder.path(), "plain", 0, 1);
    let path = folder.path().join("summary.json");
    let summary = serde_json::json!({
        "verdict": "FAIL", "scenario": "s", "device": "d", "controller": "c", "end": "the drive latched X", "faults": [],
    });
    fs::write(&path, summary.to_string()).expect("a file");
    let page = run(&Run::read("plain", folder.path()).expect("a record"));
    assert!(page.contains("The run ended at 0.000 s: the drive latched X."));
    assert!(!page.contains("<figure data-chart") && page.contains("id=\"data\">null<"), "no charts");
    fs::remove_file(path).expect("removed");
    let error = Run::read("plain", folder.path()).expect_err("neither rows nor a summary");
    assert!(matches!(error, ReadError { fault: ReadFault::Empty, .. }), "{error}");
}
