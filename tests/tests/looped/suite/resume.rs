//! Journal and records in `--out`: what a later command restores, repeats and keeps.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::time::Duration;

use rustix::process::Signal;
use tests::{c_drive, wait};

use super::fixture::{NOISE, PEAK, SHORT, Suite, with_table};

#[test]
fn a_suite_that_was_cut_short_runs_what_is_missing() {
    let suite = Suite::new(&[("a.toml", format!("{SHORT}{NOISE}"))]);
    let out = suite.path("out");
    let _ = suite.run(&["--out", &out, "--jobs", "1"]).with_code(0);
    let whole = suite.read("out/cases.jsonl");
    assert_eq!(whole.lines().count(), 5, "{whole}");
    // Without --resume or --force nothing is overwritten.
    let refused = suite.run(&["--out", &out]).with_code(2);
    assert!(refused.stderr.contains("--resume to complete it, --force to replace it"), "{}", refused.stderr);
    let two: String = whole.split_inclusive('\n').take(3).collect();
    fs::write(suite.path("out/cases.jsonl"), two + "{\"case\"").expect("a torn journal");
    let ended = suite.run(&["--out", &out, "--resume", "--jobs", "1"]).with_code(0);
    assert_eq!(ended.stderr.lines().count(), 2, "two cases are run again: {}", ended.stderr);
    let digests = |text: &str| -> Vec<String> {
        let results =
            text.lines().skip(1).map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
        results.map(|result| result["torque_sha256"].as_str().expect("a digest").to_owned()).collect()
    };
    assert_eq!(digests(&suite.read("out/cases.jsonl")), digests(&whole));
    // A case whose scenario has changed is run again, the others are not.
    suite.write("a.toml", &format!("{SHORT}{}", NOISE.replace("0.4", "0.5")));
    let ended = suite.run(&["--out", &out, "--resume"]).with_code(0);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
}

fn first_result(suite: &Suite) {
    let has_result = || {
        let journal = fs::read_to_string(suite.path("out/cases.jsonl")).unwrap_or_default();
        (journal.lines().count() == 2).then_some(())
    };
    wait::look(Duration::from_secs(60), has_result).expect("the first result");
}

#[test]
fn an_interrupted_suite_ends_its_jobs_and_can_be_resumed() {
    let endless = SHORT.replace("1.5", "1e5");
    let suite = Suite::new(&[("a.toml", SHORT.to_owned()), ("b.toml", endless.clone()), ("c.toml", endless)]);
    let [out, junit, html] = ["out", "junit.xml", "index.html"].map(|name| suite.path(name));
    let bench = suite.start(&["--out", &out, "--junit", &junit, "--html", &html, "--jobs", "2"]);
    first_result(&suite);
    bench.signal(Signal::INT);
    let ended = bench.wait().with_code(3);
    assert!(
        ended.stdout.contains("3 cases: 1 PASS, 0 FAIL, 0 INVALID, 0 ERROR, 0 SKIPPED, 2 not run"),
        "{}",
        ended.stdout
    );
    assert!(ended.stdout.ends_with("interrupted; --resume completes it\n"), "{}", ended.stdout);
    assert!(suite.read("junit.xml").contains("interrupted; 1 of 3 cases have a result"));
    assert_eq!(suite.badge("index.html"), "INCOMPLETE");
    for name in ["b.toml", "c.toml"] {
        suite.write(name, SHORT);
    }
    let ended = suite.run(&["--out", &out, "--resume"]).with_code(0);
    assert!(ended.stdout.contains("3 cases: 3 PASS"), "{}", ended.stdout);
    assert_eq!(ended.stderr.lines().count(), 2, "{}", ended.stderr);
}

#[test]
fn force_leaves_a_running_suite_alone() {
    let endless = SHORT.replace("1.5", "1e5");
    let suite = Suite::new(&[("a.toml", format!("{SHORT}{PEAK}max = 0.1\n")), ("b.toml", endless)]);
    let out = suite.path("out");
    let bench = suite.start(&["--out", &out, "--jobs", "1"]);
    first_result(&suite);
    let before = suite.read("out/cases.jsonl");
    let refused = suite.run(&["--out", &out, "--force"]).with_code(2);
    assert!(refused.stderr.contains("is being written by another lashloop"), "{}", refused.stderr);
    assert_eq!(suite.read("out/cases.jsonl"), before);
    let journal = suite.journal();
    let record = journal[0]["record"].as_str().expect("the record of a");
    assert!(Path::new(record).join("summary.json").is_file());
    bench.signal(Signal::INT);
    let _ = bench.wait().with_code(3);
    suite.write("b.toml", SHORT);
    let ended = suite.run(&["--out", &out, "--force"]).with_code(1);
    assert_eq!(ended.stderr.lines().count(), 2, "both are run again: {}", ended.stderr);
    assert_eq!(suite.journal().len(), 2);
}

#[test]
fn a_case_without_a_verdict_is_run_again() {
    let short = SHORT.replace("\"pd\"", "\"cascade\"");
    // The drive lacks the law of the last one.
    let suite = Suite::new(&[
        ("a.toml", short.clone()),
        ("b.toml", format!("{short}{PEAK}max = 0.1\n")),
        ("c.toml", SHORT.to_owned()),
    ]);
    let (out, drive) = (suite.path("out"), suite.path("drive"));
    let be = |script: &str| {
        fs::write(&drive, format!("#!/bin/sh\n{script}\n")).expect("a program");
        fs::set_permissions(&drive, fs::Permissions::from_mode(0o755)).expect("a program");
    };
    let device = format!("exec:{drive}");
    let options = ["--device", &device, "--out", &out, "--jobs", "1"];
    be("exit 1");
    let _ = suite.run(&options).with_code(4);
    be(&format!("exec '{}'", c_drive::path().display()));
    let resumed = suite.run(&[&options[..], &["--resume"]].concat()).with_code(2);
    let want = ["PASS a.toml", "FAIL b.toml", "ERROR c.toml"];
    assert_eq!(suite.rows(&resumed), want, "{}", resumed.stdout);
    let resumed = suite.run(&[&options[..], &["--resume"]].concat()).with_code(2);
    assert_eq!(suite.rows(&resumed), want, "{}", resumed.stdout);
    assert_eq!(resumed.stderr.lines().count(), 1, "a verdict stays, also a FAIL: {}", resumed.stderr);
}

#[test]
fn a_record_stays_that_of_its_case_when_cases_are_inserted() {
    let missed = format!("{SHORT}{PEAK}max = 0.1\n");
    let suite = Suite::new(&[("a.toml", format!("{missed}{NOISE}"))]);
    let out = suite.path("out");
    let _ = suite.run(&["--out", &out]).with_code(1);
    suite.write("a.toml", &format!("{missed}{}", NOISE.replace("[0.1", "[0.05, 0.1")));
    let ended = suite.run(&["--out", &out, "--resume"]).with_code(1);
    assert_eq!(ended.stderr.lines().count(), 1, "one case is new: {}", ended.stderr);
    let journal = suite.journal();
    assert_eq!(journal.len(), 5);
    for result in journal {
        let [case, record] = ["case", "record"].map(|key| result[key].as_str().expect("a text").to_owned());
        let (_, noise) = case.split_once("encoders.noise_counts=").expect("the setting");
        let scenario = fs::read_to_string(Path::new(&record).join("scenario.toml")).expect("a record");
        assert!(scenario.contains(&format!("noise_counts = {noise}\n")), "{case}: {scenario}");
    }
}

#[test]
fn a_changed_table_of_the_reference_is_a_changed_scenario() {
    let suite = Suite::new(&[("a.toml", with_table("reference.csv"))]);
    let out = suite.path("out");
    for (end_rad, runs, option) in [("0", 1, "--force"), ("0", 0, "--resume"), ("0.1", 1, "--resume")] {
        suite.write("reference.csv", &format!("time_s,position_rad\n0,0\n2,{end_rad}\n"));
        let ended = suite.run(&["--out", &out, option]).with_code(0);
        assert_eq!(ended.stderr.lines().count(), runs, "{end_rad} {option}: {}", ended.stderr);
    }
}
