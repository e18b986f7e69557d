//! `lashloop diff`: what was set differently is named, and the first step that differs.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use crate::samples;
use crate::support::{lashloop, root, text};

/// Folders with records of 0.2 s.
pub struct Runs(TempDir);

impl Runs {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn folder(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn run(&self, name: &str, arguments: &[&str]) -> PathBuf {
        let (scenario, out) = (root().join("scenarios/smooth-after.toml"), self.folder(name));
        let [scenario, folder] = [&scenario, &out].map(|path| path.to_str().unwrap());
        let fixed = ["run", scenario, "--device", "inproc", "--out", folder];
        let short = ["--set", "run.duration_s=0.2", "--set", "expect=[]"];
        let ended = lashloop(&[&fixed[..], &short, arguments].concat(), &[]);
        // A busy machine is late in real time.
        let late = ended.status.code() == Some(3) && arguments.contains(&"real-time");
        assert!(ended.status.code() == Some(0) || late, "{}", text(&ended.stderr));
        out
    }
}

/// Exit code, and what is printed.
fn diff(a: &Path, b: &Path, options: &[&str]) -> (Option<i32>, String) {
    let ended = lashloop(&[&["diff", a.to_str().unwrap(), b.to_str().unwrap()], options].concat(), &[]);
    (ended.status.code(), format!("{}{}", text(&ended.stdout), text(&ended.stderr)))
}

fn json(a: &Path, b: &Path, options: &[&str]) -> (Option<i32>, Value) {
    let (code, printed) = diff(a, b, &[&["--json"], options].concat());
    (code, serde_json::from_str(&printed).unwrap_or_else(|error| panic!("{error}: {printed}")))
}

fn setting<'a>(comparison: &'a Value, key: &str) -> &'a Value {
    let settings = comparison["settings"].as_array().unwrap();
    let found = settings.iter().find(|it| it["key"] == key);
    &found.unwrap_or_else(|| panic!("no {key} in {settings:?}"))["values"]
}

fn signal<'a>(comparison: &'a Value, name: &str) -> &'a Value {
    comparison["signals"].as_array().unwrap().iter().find(|it| it["name"] == name).unwrap()
}

#[test]
fn run_and_its_repetition_are_equal_bit_for_bit() {
    let runs = Runs::new();
    let (code, printed) = diff(&runs.run("a", &[]), &runs.run("b", &[]), &[]);
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.ends_with("EQUAL bit for bit\n") && printed.contains("Rows compared: 200"), "{printed}");
}

#[test]
fn changed_gain_is_named_with_the_first_step_that_differs() {
    let runs = Runs::new();
    let a = runs.run("a", &["--set", "controller.parameters.k_p2=10.0"]);
    let b = runs.run("b", &["--set", "controller.parameters.k_p2=10.5"]);
    let (code, comparison) = json(&a, &b, &[]);
    assert_eq!((code, &comparison["agreement"]), (Some(1), &Value::from("different")));
    assert_eq!(setting(&comparison, "controller.parameters.k_p2"), &serde_json::json!(["10.0", "10.5"]));
    assert_eq!(comparison["first"]["step"], 0, "the load starts away from its reference");
    let torque = signal(&comparison, "torque_nm");
    assert_eq!((torque["first"]["step"].as_i64(), torque["within"].as_bool()), (Some(0), Some(false)));
    let load = signal(&comparison, "load_position_rad");
    assert!(load["first"]["step"].as_i64() > Some(0), "a position follows its torque: {load}");
    let largest = torque["largest"]["values"].as_array().unwrap();
    let amount = (largest[1].as_f64().unwrap() - largest[0].as_f64().unwrap()).abs();
    let limit = format!("torque_nm={}", amount * 1.001);
    assert_eq!(diff(&a, &b, &["--only", "torque_nm", "--tolerance", &limit]).0, Some(0));
    let below = format!("torque_nm={}", amount * 0.999);
    assert_eq!(diff(&a, &b, &["--only", "torque_nm", "--tolerance", &below]).0, Some(1));
}

#[test]
fn changed_law_is_named_with_the_signals_that_one_record_lacks() {
    let runs = Runs::new();
    let signals = ["--set", "telemetry.signals=[\"load_error_rad\"]"];
    let (a, b) = (runs.run("a", &signals), runs.run("b", &["--controller", "backlash-inverse"]));
    let (code, printed) = diff(&a, &b, &[]);
    assert_eq!(code, Some(1), "{printed}");
    for words in ["merzouki", "backlash-inverse", "Only in B: drive.", "DIFFERENT"] {
        assert!(printed.contains(words), "no {words:?} in {printed}");
    }
}

#[test]
fn interrupted_record_is_compared_up_to_its_last_row() {
    let runs = Runs::new();
    let (a, b) = (
        runs.run("a", &["--set", "record.flush_rows=50"]),
        runs.run("b", &["--set", "record.flush_rows=50"]),
    );
    interrupt(&b);
    let (_, comparison) = json(&a, &b, &[]);
    let compared = comparison["coverage"]["compared"].as_u64().unwrap();
    assert!([50, 100, 150].contains(&compared), "whole chunks: {compared}");
    let (code, printed) = diff(&a, &b, &[]);
    assert_eq!(code, Some(1), "{printed}");
    let rest = format!("Only in A: {} rows", 200 - compared);
    for words in ["interrupted", &rest, "equal bit for bit"] {
        assert!(printed.contains(words), "no {words:?} in {printed}");
    }
    assert_eq!(diff(&a, &b, &["--until", "0.04"]).0, Some(0), "both have this part");
}

/// Leaves what a run leaves that is killed in its midst.
fn interrupt(folder: &Path) {
    fs::remove_file(folder.join("summary.json")).unwrap();
    let samples = fs::read(folder.join("run.mcap")).unwrap();
    fs::write(folder.join("run.mcap"), &samples[..samples.len() / 2]).unwrap();
}

/// Makes a record one of a run in real time that had no torque in time in this step, if any, and ended so after some steps.
fn in_real_time(folder: &Path, late: Option<u64>, steps: u64, end: &str) {
    for (name, key, value) in [("record.json", "clock", "real-time"), ("summary.json", "end", end)] {
        let mut file: Value = serde_json::from_slice(&fs::read(folder.join(name)).unwrap()).unwrap();
        file[key] = value.into();
        fs::write(folder.join(name), file.to_string()).unwrap();
    }
    samples::rewrite(folder, |message| {
        let step = samples::step(message);
        if Some(step) == late && message.channel.topic == "/step" {
            samples::unanswer(message);
        }
        step < steps
    });
}

#[test]
fn run_in_real_time_that_ended_early_or_otherwise_is_different() {
    let runs = Runs::new();
    let (a, b) = (runs.run("a", &[]), runs.run("b", &[]));
    in_real_time(&a, Some(100), 200, "complete");
    let whole = fs::read(b.join("run.mcap")).unwrap();
    for (steps, end, want) in [
        (200, "complete", 0),
        (200, "the drive latched LoadSpeed", 1),
        (150, "the drive latched LoadSpeed", 1),
        (50, "complete", 1),
        (150, "complete", 0),
    ] {
        fs::write(b.join("run.mcap"), &whole).unwrap();
        in_real_time(&b, None, steps, end);
        let (code, printed) = diff(&a, &b, &["--deterministic"]);
        assert!(printed.contains("Judged until 0.1 s"), "{printed}");
        assert_eq!(code, Some(want), "{steps} steps, {end}: {printed}");
    }
}

#[test]
fn a_metric_alone_is_compared() {
    let runs = Runs::new();
    let a = runs.run("a", &[]);
    let b = runs.run("b", &["--set", "controller.parameters.k_p2=10.5"]);
    for (other, want) in [(&a, 0), (&b, 1)] {
        let (code, printed) = diff(&a, other, &["--only", "rms_torque_nm"]);
        assert!(code == Some(want) && !printed.contains("nothing can be judged"), "{code:?}: {printed}");
    }
}

#[test]
fn other_period_is_compared_at_common_times() {
    let runs = Runs::new();
    let (a, b) = (runs.run("a", &[]), runs.run("b", &["--set", "run.control_period_us=2000"]));
    let (code, comparison) = json(&a, &b, &["--tolerance", "1000%", "--only", "reference_rad"]);
    assert_eq!(code, Some(0), "{comparison}");
    assert_eq!(comparison["coverage"]["period_us"], serde_json::json!([1000, 2000]));
    assert_eq!(comparison["coverage"]["compared"], 100);
    assert_eq!(diff(&a, &b, &[]).0, Some(1));
}

#[test]
fn records_that_cannot_be_compared_are_named() {
    let runs = Runs::new();
    let a = runs.run("a", &[]);
    let absent = runs.folder("absent");
    for (b, options, part) in [
        (&absent, &[][..], "absent"),
        (&a, &["--from", "7"], "no time in common"),
        (&a, &["--tolerance", "torque_mm=1"], "did you mean torque_nm?"),
        (&a, &["--only", "torque_mm"], "did you mean torque_nm?"),
        (&a, &["--tolerance", "0.1"], "a percentage for all"),
        (&a, &["--from", "3", "--until", "2"], "empty range"),
    ] {
        let (code, printed) = diff(&a, b, options);
        assert_eq!(code, Some(2), "{options:?}: {printed}");
        assert!(printed.contains(part), "{options:?}: no {part:?} in {printed}");
    }
    fs::write(a.join("summary.json"), "{").unwrap();
    let (code, printed) = diff(&a, &a, &[]);
    assert!(code == Some(2) && printed.contains("summary.json"), "{printed}");
}
