//! `lashloop battery`: tables, limits, interruption and resumption.

use std::collections::BTreeMap;
use std::fs;

use rustix::process::Signal;
use tests::program::{self, Ended, Running};
use tests::records::Records;
use tests::{wait, workspace};

/// Arguments of a battery with a folder for its results.
fn arguments(records: &Records, rest: &str) -> Vec<String> {
    let words = format!("battery {rest} --out {}", records.out());
    words.split_whitespace().map(str::to_owned).collect()
}

fn run(records: &Records, rest: &str) -> Ended {
    program::run(arguments(records, rest))
}

fn text(records: &Records, name: &str) -> String {
    fs::read_to_string(records.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The files of a battery, independent of the order in which runs ended.
fn left(records: &Records) -> [String; 3] {
    let mut journal: Vec<_> = text(records, "runs.jsonl").lines().map(str::to_owned).collect();
    journal[1..].sort_unstable();
    [journal.join("\n"), text(records, "runs.csv"), text(records, "battery.json")]
}

/// The rows of `runs.csv`, each by its columns.
fn rows(records: &Records) -> Vec<BTreeMap<String, String>> {
    let text = text(records, "runs.csv");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

#[test]
fn short_battery_meets_its_limits_and_its_rows_can_be_rerun() {
    let records = Records::new();
    let ended = run(&records, "--plants 20").with_code(0);
    assert!(ended.stdout.ends_with("PASS\n"), "{}", ended.stdout);
    assert_eq!(ended.stdout.lines().filter(|line| line.starts_with("met ")).count(), 12, "{}", ended.stdout);
    // The sweeps do not depend on the number of plants, so docs/robustness.md has the same lines.
    let (_, sweeps) = ended.stdout.split_once("\n\ntrue j0").expect("the first sweep");
    let (sweeps, _) = sweeps.split_once("\n\nlimits of").expect("the end of the last");
    let document = fs::read_to_string(workspace().join("docs/robustness.md")).expect("the document");
    for line in sweeps.lines().skip(1).filter(|line| !line.is_empty()) {
        assert!(document.contains(&format!("    {line}\n")), "not in docs/robustness.md: {line}");
    }
    let report: serde_json::Value =
        serde_json::from_str(&text(&records, "battery.json")).expect("battery.json is JSON");
    assert_eq!(report["verdict"], "PASS");
    let rows = rows(&records);
    // 20 plants, and 34 values of seven sweeps.
    assert_eq!(rows.len(), 4 * (20 + 34));
    for law in ["pd", "merzouki", "backlash-inverse", "braking-curve"] {
        let random = |row: &&BTreeMap<_, _>| row["part"] == "random-plants" && row["controller"] == law;
        let row = rows.iter().filter(random).nth(13).expect("a row");
        let alone = Records::new();
        let scenario = format!("scenarios/shaft-{law}.toml");
        let settings = row["set"].split(' ').flat_map(|set| ["--set".to_owned(), set.to_owned()]);
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
fn braking_curve_meets_its_limits_on_seeds_outside_its_tuning() {
    for seed in [11, 12, 13] {
        let line = format!("battery --plants 60 --controller braking-curve --no-sweeps --seed {seed}");
        let ended = program::run(line.split(' ')).with_code(0);
        assert_eq!(
            ended.stdout.lines().filter(|line| line.starts_with("met ")).count(),
            8,
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

/// A battery in progress, with some results.
fn in_progress(records: &Records) -> Running {
    let bench = Running::start(arguments(records, SMALL));
    wait::until("results in runs.jsonl", || {
        let lines = fs::read_to_string(records.path("runs.jsonl")).ok()?.lines().count();
        (lines > 3).then_some(())
    });
    bench
}

/// Resumes a battery and requires the results of an uninterrupted one.
fn resumes_to_the_same_results(records: &Records) {
    let made = text(records, "runs.jsonl").matches("\"end\"").count();
    assert!((3..20).contains(&made), "{made} runs in the journal");
    let resumed = run(records, &format!("{SMALL} --resume")).with_code(0);
    assert_eq!(resumed.stderr, format!("{made} of 20 runs restored from the journal\n"));
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
    assert_eq!(ended.stderr, "");
    assert!(text(&records, "runs.jsonl").ends_with('\n'));
    assert!(!records.path("battery.json").exists(), "no report on a part of a battery");
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
        ("--plants 1 --controller pd --no-sweeps --resume".to_owned(), "its list of controllers is"),
        (ONE.replace("--plants 1", "--plants 2 --resume"), "its number of plants is 1, here it is 2"),
        ("--plants 1 --controller backlash-inverse --resume".to_owned(), "its choice of sweeps is without"),
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
    let journal = text(&records, "runs.jsonl");
    let (before, scores) = journal.split_once("\"scores\":{").expect("scores");
    let (scores, after) = scores.split_once('}').expect("their end");
    let names = scores.split(',').map(|score| score.split_once(':').expect("a name").0);
    let diverged: Vec<_> = names.map(|name| format!("{name}:\"not finite\"")).collect();
    let journal = format!("{before}\"scores\":{{{}}}{after}", diverged.join(","));
    fs::write(records.path("runs.jsonl"), journal).expect("a journal");
    let ended = run(&records, &format!("{ONE} --resume")).with_code(1);
    assert!(ended.stdout.ends_with("FAIL\n"), "{}", ended.stdout);
    assert_eq!(
        ended.stdout.lines().filter(|line| line.starts_with("MISSED ")).count(),
        4,
        "{}",
        ended.stdout
    );
    assert_eq!(ended.stdout.matches("not finite").count(), 10 * 3 + 4 + 1, "{}", ended.stdout);
}

#[test]
fn wrong_options_of_a_battery_are_refused_with_the_alternative() {
    for (arguments, expected) in [
        ("battery --controller lqr", "expected pd, merzouki, backlash-inverse or braking-curve"),
        ("battery --plants 0", "0 is not in 1..=100000"),
        ("battery --jobs 0", "number would be zero"),
        ("battery --resume", "--out <DIR>"),
        ("battery --out Cargo.toml/out", "choose another folder with --out"),
    ] {
        let ended = program::run(arguments.split(' ')).with_code(2);
        assert!(ended.stderr.contains(expected), "{arguments}: {}", ended.stderr);
        assert_eq!(ended.stdout, "", "{arguments}");
    }
}
