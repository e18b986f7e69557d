//! Pages of campaigns with synthetic results: numbers, size, text of others.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use lashloop_bench::scenario::plant::standard;
use lashloop_campaign::cell::{Cell, Missing};
use lashloop_campaign::facts::{Facts, Program};
use lashloop_campaign::row::{CaseResult, Columns};
use lashloop_campaign::table::Table;
use lashloop_campaign::view::View;
use lashloop_campaign::{Campaign, Selection, Source};
use lashloop_plant::metrics::Metric;
use lashloop_report::page::{self, CampaignResults};
use serde_json::Value;

const HOSTILE: &str = "</script><script>alert(1)</script><img src=x onerror=alert(2)>";
const VARIANTS: &str = "[[variant]]\nname = \"one\"\n[[variant]]\nname = \"two\"\n";

fn axis(key: &str, rest: &str) -> String {
    format!("[[part.axis]]\nkey = \"{key}\"\nlabel = \"{HOSTILE}\"\nmin = 0.1\nmax = 0.2\n{rest}\n")
}

fn campaign(parts: &str) -> Campaign {
    let text = format!(
        "title = \"{HOSTILE}\"\nscenario = \"pd.toml\"\nset = [\"meant=mismatch\"]\n{VARIANTS}{parts}\n[[expect]]\nmetric = \"settle_time_s\"\n\
         quantile = 0.5\nmax = 0.4\n[[expect]]\npass = 0.5\n"
    );
    let source = |path: &str, text: &str| Source { path: path.to_owned(), text: text.to_owned() };
    let sources =
        vec![source("c.toml", &text), source("pd.toml", include_str!("../../../scenarios/shaft-pd.toml"))];
    Campaign::from_sources(sources, Selection::default(), &standard()).expect("a campaign")
}

/// Every metric has a value, apart from every fifth settling time; every seventh run fails.
fn result(case: u64) -> CaseResult {
    let cell = |(at, metric): (usize, &Metric)| match metric {
        Metric::SettleTime if case.is_multiple_of(5) => Cell::Missing(Missing::Never),
        _ => Cell::Value(((case + at as u64).wrapping_mul(7919) % 1009) as f64 / 1009.0 - 0.25),
    };
    CaseResult {
        cells: Metric::ALL.iter().enumerate().map(cell).collect(),
        verdict: if case.is_multiple_of(7) { "FAIL" } else { "PASS" }.to_owned(),
        end: "complete".to_owned(),
        torque_sha256: "00".repeat(32),
    }
}

fn write(campaign: &Campaign, path: &Path) {
    let columns = Columns::of(campaign);
    let mut file = BufWriter::new(File::create(path).expect("a table"));
    let mut line = columns.header();
    for case in 0..campaign.plan.cases() {
        columns.write(campaign, &campaign.plan.case(case), &result(case), &mut line);
        file.write_all(&line).expect("a row");
        line.clear();
    }
}

fn page(campaign: &Campaign, view: &View, shards: u32) -> String {
    let text = |text: &str| text.to_owned();
    let program =
        Program { lashloop: text("1"), sha256: text("aa"), device: text("inproc"), drive: text(HOSTILE) };
    let facts = Facts::new(campaign, program, shards);
    page::campaign(&CampaignResults {
        campaign,
        facts: &facts,
        view,
        evidence: &[],
        folder: Path::new("out/c"),
    })
}

fn made(parts: &str) -> (Campaign, View) {
    let (campaign, folder) = (campaign(parts), tempfile::tempdir().expect("a folder"));
    let path = folder.path().join("results.csv");
    write(&campaign, &path);
    let view = View::new(&Table::new(&campaign, &path)).expect("a view");
    (campaign, view)
}

fn two_parts() -> String {
    let random = format!(
        "[[part]]\nname = \"random\"\nmethod = \"random\"\npoints = 40\n{}",
        axis("plant.dead_zone_rad", "")
    );
    let grid = ["plant.dead_zone_rad", "plant.current_lag_ms"].map(|key| axis(key, "points = 3")).concat();
    let expect = "[[expect]]\npart = \"random\"\nvariant = \"one\"\npass = 0.6\nconfidence = 0.9\n";
    format!("{random}[[part]]\nname = \"grid\"\n{grid}{expect}")
}

/// The text behind the first of these marks, each behind the one before.
fn behind<'a>(text: &'a str, marks: &[&str]) -> &'a str {
    marks.iter().fold(text, |rest, mark| rest.split_once(mark).unwrap_or_else(|| panic!("no {mark}")).1)
}

#[test]
fn numbers_of_the_page_equal_those_of_the_report() {
    let (campaign, view) = made(&two_parts());
    let page = page(&campaign, &view, 1);
    let report = serde_json::to_value(&view.report).expect("a report");
    let mut compared = 0;
    for group in report["groups"].as_array().expect("groups") {
        let [part, variant] = ["part", "variant"].map(|name| group[name].as_str().expect("a name"));
        for column in group["columns"].as_array().expect("columns") {
            let name = column["column"].as_str().expect("a name");
            let Some((_, block)) = page.split_once(&format!("data-choice=\"{name}\"")) else { continue };
            let row = format!("data-part=\"{part}\" data-variant=\"{variant}\"");
            for quantile in ["median", "p80", "p95", "p99", "max"] {
                let cell = behind(block, &[&row, &format!("data-quantile=\"{quantile}\">")]);
                match &column[quantile] {
                    Value::Number(number) => {
                        let shown = behind(cell, &["value=\""]).split('"').next().expect("a number");
                        assert_eq!(shown.parse().ok(), number.as_f64(), "{part} {variant} {name} {quantile}");
                    }
                    reason => assert!(cell.starts_with(&format!(
                        "<span class=\"absent\">{}",
                        reason.as_str().expect("a reason")
                    ))),
                }
                compared += 1;
            }
        }
    }
    assert!(compared >= 4 * 5 * 5, "{compared} numbers");
    for (at, expectation) in view.report.expectations.iter().enumerate() {
        let Cell::Value(value) = expectation.value else { panic!("no value") };
        let table = behind(&page, &["id=\"expectations\""]).split("</table>").next().expect("a table");
        assert_eq!(table.matches(&format!("data value=\"{value}\"")).count(), 1, "expectation {at}");
    }
}

#[test]
fn page_does_not_depend_on_the_number_of_shards() {
    let (campaign, view) = made(&two_parts());
    assert!(page(&campaign, &view, 1) == page(&campaign, &view, 7));
}

#[test]
fn text_of_a_campaign_is_no_script() {
    let (campaign, view) = made(&two_parts());
    let page = page(&campaign, &view, 1);
    assert!(page.contains("&lt;/script&gt;&lt;script&gt;alert(1)"));
    assert!(!page.contains("<script>alert") && !page.contains("<img"), "text of others became a tag");
}

#[test]
fn page_of_100_000_runs_stays_below_1_mb() {
    let sampled = [
        "load_inertia_kg_m2",
        "stiffness_nm_rad",
        "dead_zone_rad",
        "current_lag_ms",
        "shaft_damping_nm_s_rad",
    ];
    let sampled = sampled.map(|key| axis(&format!("plant.{key}"), "")).concat();
    let grid = [
        "plant.dead_zone_rad",
        "plant.current_lag_ms",
        "plant.shaft_damping_nm_s_rad",
        "plant.load_friction_nm_s_rad",
    ];
    let grid = grid.map(|key| axis(key, "points = 10")).concat();
    let parts = format!(
        "[[part]]\nname = \"sampled\"\nmethod = \"sobol\"\npoints = 40000\n{sampled}[[part]]\nname = \"grid\"\n{grid}"
    );
    let (campaign, view) = made(&parts);
    assert_eq!(campaign.plan.cases(), 100_000);
    let page = page(&campaign, &view, 1);
    println!("page of 100,000 runs: {} kB", page.len() / 1000);
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
}
