//! A million cases planned, written, merged and reported within 512 MB. The results are synthetic: no run is made. The test is
//! a program of its own, so that the peak of its memory is that of this campaign.

use std::fs;
use std::num::NonZeroUsize;

use lashloop_bench::scenario::plant::standard;
use lashloop_bench::supervisor::Supervisor;
use lashloop_campaign::cell::{Cell, Missing};
use lashloop_campaign::engine::ShardRun;
use lashloop_campaign::facts::{Facts, Program};
use lashloop_campaign::merge::{RESULTS, merge};
use lashloop_campaign::row::CaseResult;
use lashloop_campaign::shard::Shard;
use lashloop_campaign::shard_file::Start;
use lashloop_campaign::table::Table;
use lashloop_campaign::view::View;
use lashloop_campaign::{Campaign, Selection, Source};
use lashloop_plant::metrics::Metric;

const CASES: u64 = 1_000_000;
const LIMIT_KB: u64 = 512 * 1024;

const FILE: &str = r#"
    title = "synthetic"
    scenario = "pd.toml"
    set = ["meant=mismatch"]
    [[part]]
    name = "all"
    method = "latin-hypercube"
    points = 1000000
    [[part.axis]]
    key = "plant.dead_zone_rad"
    min = 0.1
    max = 0.2
    [[expect]]
    metric = "settle_time_s"
    quantile = 0.95
    max = 0.95
    confidence = 0.95
"#;

fn peak_kb() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("the status of this process");
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).expect("a peak");
    line.split_whitespace().nth(1).and_then(|number| number.parse().ok()).expect("a number of kB")
}

#[test]
fn million_synthetic_cases_are_planned_merged_and_reported_within_512_mb() {
    let source = |path: &str, text: &str| Source { path: path.to_owned(), text: text.to_owned() };
    let scenario = include_str!("../../../scenarios/shaft-pd.toml");
    let sources = vec![source("c.toml", FILE), source("pd.toml", scenario)];
    let campaign = Campaign::from_sources(sources, Selection::default(), &standard()).expect("a campaign");
    assert_eq!(campaign.plan.cases(), CASES);
    let text = |text: &str| text.to_owned();
    let program =
        Program { lashloop: text("1"), sha256: text("aa"), device: text("synthetic"), drive: text("none") };
    let (facts, folder) = (Facts::new(&campaign, program, 2), tempfile::tempdir().expect("a folder"));
    let supervisor = Supervisor::without_signals(None).expect("a supervisor");
    // As many numbers as one pass of the report collects, and more.
    let mut cells = vec![Cell::Missing(Missing::Unmeasured); Metric::ALL.len()];
    cells[..20].fill(Cell::Value(0.5));
    for number in 1..=2 {
        let shard = Shard::new(number, 2).expect("a shard");
        let jobs = NonZeroUsize::new(2).expect("a number");
        let run = ShardRun {
            campaign: &campaign,
            facts: &facts,
            folder: folder.path(),
            shard,
            start: Start::New,
            jobs,
        };
        let run_one = |case: u64, _: &lashloop_campaign::workers::Stop<'_>| {
            let mut cells = cells.clone();
            cells[0] = Cell::Value((case * 7919 % CASES) as f64 / CASES as f64);
            let (verdict, end) = (text("PASS"), text("complete"));
            let result = CaseResult { cells, verdict, end, torque_sha256: text(&"00".repeat(32)) };
            Ok(Some((campaign.case(case)?, result)))
        };
        let done = run.run(&supervisor, run_one, |_| {}).expect("a shard");
        assert_eq!(done.rows, CASES / 2);
    }
    merge(folder.path()).expect("a table");
    let path = folder.path().join(RESULTS);
    let view = View::new(&Table::new(&campaign, &path)).expect("a report");
    // 7919 is prime, so the values are 0 to 0.999999, each once.
    assert_eq!(view.report.expectations[0].value, Cell::Value(0.949_999));
    let peak_kb = peak_kb();
    println!("peak of {CASES} synthetic cases: {} MB", peak_kb / 1024);
    assert!(peak_kb < LIMIT_KB, "peak {peak_kb} kB, at most {LIMIT_KB} kB");
}
