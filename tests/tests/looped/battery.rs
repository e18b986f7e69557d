//! `lashloop paper battery`: tables, limits, interruption and resumption.

use std::collections::BTreeMap;
use std::fs;

use rustix::process::Signal;
use tests::program::{self, Ended, Running};
use tests::records::Records;
use tests::{wait, workspace};

/// Arguments of a battery with a folder for its results.
fn arguments(records: &Records, rest: &str) -> Vec<String> {
    let words = format!("paper battery {rest} --out {}", records.out());
    words.split_whitespace().map(str::to_owned).collect()
}

fn run(records: &Records, rest: &str) -> Ended {
    program::run(arguments(records, rest))
}

fn text(records: &Records, name: &str) -> String {
    fs::read_to_string(records.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The results of a battery.
fn left(records: &Records) -> [String; 2] {
    ["results.csv", "report.json"].map(|name| text(records, name))
}

/// The rows of `results.csv`, each by its columns.
fn rows(records: &Records) -> Vec<BTreeMap<String, String>> {
    let text = text(records, "results.csv");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

#[test]
fn short_battery_meets_its_limits_and_its_rows_can_be_rerun() {
    let records = Records::new();
    let ended = run(&records, "--plants 20").with_code(0);
    assert!(ended.stdout.ends_with("PASS\n"), "{}", ended.stdout);
    assert_eq!(ended.stdout.lines().filter(|line| line.starts_with("met ")).count(), 13, "{}", ended.stdout);
    // The sweeps do not depend on the number of plants, so docs/robustness.md has the same lines.
    let (_, sweeps) = ended.stdout.split_once("\n\ntrue j0").expect("the first sweep");
    let (sweeps, _) = sweeps.split_once("\n\nlimits of").expect("the end of the last");
    let document = fs::read_to_string(workspace().join("docs/robustness.md")).expect("the document");
    for line in sweeps.lines().skip(1).filter(|line| !line.is_empty()) {
        assert!(document.contains(&format!("    {line}\n")), "not in docs/robustness.md: {line}");
    }
    let report: serde_json::Value =
        serde_json::from_str(&text(&records, "report.json")).expect("report.json is JSON");
    assert_eq!(report["verdict"], "PASS");
    let rows = rows(&records);
    // 20 plants, and 34 values of seven sweeps.
    assert_eq!(rows.len(), 4 * (20 + 34));
    for law in ["pd", "merzouki", "backlash-inverse", "braking-curve"] {
        let random = |row: &&BTreeMap<_, _>| row["part"] == "random-plants" && row["variant"] == law;
        let row = rows.iter().filter(random).nth(13).expect("a row");
        let alone = Records::new();
        let scenario = format!("scenarios/shaft-{law}.toml");
        let show = format!("campaign show campaigns/battery.toml --case {}", row["case"]);
        let shown = program::run(show.split(' ')).with_code(0).stdout;
        let settings = shown.lines().filter_map(|line| line.strip_prefix("--set "));
        let settings = settings.flat_map(|set| ["--set".to_owned(), set.to_owned()]);
        let words = ["run", &scenario, "--device", "inproc", "--out", &alone.out()].map(str::to_owned);
        // The verdict does not matter: its expectations hold for another plant.
        let _ = program::run(words.into_iter().chain(settings));
        let summary = alone.summary();
        assert_eq!(summary["torque_sha256"], row["torque_sha256"].as_str(), "{law}");
        let settle_time = summary["metrics"]["settle_time_s"].as_f64();
        assert_eq!(settle_time, row["settle_time_s"].parse().ok(), "{law}");
    }
}

#[test]
fn harder_battery_runs_every_part_and_meets_its_limits() {
    let records = Records::new();
    let ended = run(&records, "--hard --plants 1 --controller braking-curve").with_code(0);
    assert!(ended.stdout.ends_with("PASS\n"), "{}", ended.stdout);
    assert_eq!(ended.stdout.lines().filter(|line| line.starts_with("met ")).count(), 18, "{}", ended.stdout);
    let rows = rows(&records);
    // Five parts with random plants, and 69 values of 17 sweeps.
    assert_eq!(rows.len(), 5 + 69);
    assert!(rows.iter().all(|row| !row["end"].starts_with("no run")));
    let of = |part: &str| rows.iter().find(|row| row["part"] == part).expect("a row");
    for (part, column, is_number) in [
        ("alternating-moves", "settle_over_minimum", false),
        ("alternating-moves", "settle_after_every_move_s", true),
        ("random-hard", "settle_over_minimum", true),
        ("random-hard", "settle_after_every_move_s", false),
        ("random-hard", "dead_zone_beyond_two_deviations", true),
    ] {
        let field = &of(part)[column];
        assert_eq!(field.parse::<f64>().is_ok(), is_number, "{part}: {column} is {field}");
    }
}

#[test]
fn braking_curve_meets_its_limits_on_seeds_outside_its_tuning() {
    for seed in [11, 12, 13] {
        let line = format!("paper battery --plants 60 --controller braking-curve --no-sweeps --seed {seed}");
        let ended = program::run(line.split(' ')).with_code(0);
        assert_eq!(
            ended.stdout.lines().filter(|line| line.starts_with("met ")).count(),
            9,
            "{}",
            ended.stdout
        );
    }
}

#[test]
fn same_seed_gives_the_same_table_for_any_number_of_jobs() {
    let battery = |rest: &str| {
        let records = Records::new();
        let ended = run(&records, &format!("--plants 4 --no-sweeps {rest}"));
        (ended.stdout, left(&records))
    };
    let alone = battery("--jobs 1");
    assert_eq!(alone, battery("--jobs 3"));
    assert_ne!(alone.0, battery("--jobs 3 --seed 2").0);
}

const SMALL: &str = "--plants 10 --controller merzouki,backlash-inverse --no-sweeps --jobs 1";

/// The rows so far.
fn part(records: &Records) -> String {
    fs::read_to_string(records.path("shard-1-of-1.csv.part")).unwrap_or_default()
}

/// A battery in progress, with some results.
fn in_progress(records: &Records) -> Running {
    let bench = Running::start(arguments(records, SMALL));
    wait::until("rows", || (part(records).lines().count() > 3).then_some(()));
    bench
}

/// Resumes a battery and requires the results of an uninterrupted one.
fn resumes_to_the_same_results(records: &Records) {
    let made = part(records).matches('\n').count() - 1;
    assert!((3..20).contains(&made), "{made} rows");
    let resumed = run(records, &format!("{SMALL} --resume")).with_code(0);
    assert_eq!(resumed.stderr, format!("{made} of 20 runs restored\n"));
    let whole = Records::new();
    assert_eq!(resumed.stdout, run(&whole, SMALL).with_code(0).stdout);
    assert_eq!(left(records), left(&whole));
}

#[test]
fn killed_battery_resumes_to_the_same_results() {
    let records = Records::new();
    let bench = in_progress(&records);
    bench.signal(Signal::KILL);
    assert_eq!(bench.wait().code, None);
    resumes_to_the_same_results(&records);
}

#[test]
fn interrupted_battery_keeps_its_results_and_resumes() {
    let records = Records::new();
    let bench = in_progress(&records);
    bench.signal(Signal::INT);
    let ended = bench.wait().with_code(3);
    assert!(ended.stdout.starts_with("interrupted: "), "{}", ended.stdout);
    assert!(ended.stdout.ends_with("resume with --resume\n"), "{}", ended.stdout);
    assert_eq!(ended.messages(), [""; 0]);
    assert!(part(&records).ends_with('\n'));
    assert!(!records.path("report.json").exists(), "no report on a part of a battery");
    resumes_to_the_same_results(&records);
}

const ONE: &str = "--plants 1 --controller backlash-inverse --no-sweeps";

#[test]
fn results_of_another_battery_are_refused_and_kept() {
    let records = Records::new();
    let _ = run(&records, ONE).with_code(0);
    let before = left(&records);
    for (rest, expected) in [
        (format!("{ONE} --resume --seed 2"), "its seed is 1, here it is 2"),
        ("--plants 1 --controller pd --no-sweeps --resume".to_owned(), "its list of variants is"),
        (ONE.replace("--plants 1", "--plants 2 --resume"), "its number of points is 1, here it is 2"),
        (
            "--plants 1 --controller backlash-inverse --resume".to_owned(),
            "its list of parts is random-plants",
        ),
        (ONE.to_owned(), "already holds results: resume with --resume"),
    ] {
        let ended = run(&records, &rest).with_code(2);
        assert!(ended.stderr.contains(expected), "{expected}: {}", ended.stderr);
        assert_eq!(ended.stdout, "");
        assert_eq!(left(&records), before, "a refusal changes nothing");
    }
}

#[test]
fn diverged_run_is_counted_and_fails_the_battery() {
    let records = Records::new();
    let _ = run(&records, ONE).with_code(0);
    let table = records.path("shard-1-of-1.csv");
    let before = fs::read_to_string(&table).expect("the shard");
    let (header, row) = before.split_once('\n').expect("two lines");
    let numbers = header.split(',').position(|name| name == "settle_time_s").expect("a column");
    let last = header.split(',').position(|name| name == "verdict").expect("a column");
    let diverged = row.trim_end().split(',').enumerate();
    let diverged =
        diverged.map(|(at, field)| if (numbers..last).contains(&at) { "not finite" } else { field });
    let diverged = format!("{header}\n{}\n", diverged.collect::<Vec<_>>().join(","));
    // As a kill after the last row leaves it: a complete table must have the hash that it was completed with.
    fs::remove_file(&table).expect("the shard");
    fs::write(table.with_extension("csv.part"), diverged).expect("the shard");
    let ended = run(&records, &format!("{ONE} --resume")).with_code(1);
    assert!(ended.stdout.ends_with("FAIL\n"), "{}", ended.stdout);
    assert_eq!(
        ended.stdout.lines().filter(|line| line.starts_with("MISSED ")).count(),
        4,
        "{}",
        ended.stdout
    );
    assert_eq!(ended.stdout.matches("not finite").count(), 9 * 3 + 4 + 1, "{}", ended.stdout);
}

#[test]
fn wrong_options_of_a_battery_are_refused_with_the_alternative() {
    for (arguments, expected) in [
        ("paper battery --controller lqr", "expected pd, merzouki, backlash-inverse or braking-curve"),
        ("paper battery --plants 0", "0 is not in 1..=100000"),
        ("paper battery --jobs 0", "number would be zero"),
        ("paper battery --resume", "--out <DIR>"),
        ("paper battery --out Cargo.toml/out", "choose another folder with --out"),
    ] {
        let ended = program::run(arguments.split(' ')).with_code(2);
        assert!(ended.stderr.contains(expected), "{arguments}: {}", ended.stderr);
        assert_eq!(ended.stdout, "", "{arguments}");
    }
}
