//! `lashloop rerun` and `lashloop replay` on the records of `lashloop run`.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::diff::Runs;
use crate::support::{lashloop, text};

/// Exit code, and what is printed.
fn on(command: &str, record: &Path, options: &[&str]) -> (Option<i32>, String) {
    let ended = lashloop(&[&[command, record.to_str().unwrap()], options].concat(), &[]);
    (ended.status.code(), format!("{}{}", text(&ended.stdout), text(&ended.stderr)))
}

fn rerun(record: &Path, options: &[&str]) -> (Option<i32>, String) {
    on("rerun", record, options)
}

fn replay(record: &Path, options: &[&str]) -> (Option<i32>, String) {
    on("replay", record, options)
}

/// Changes the manifest of a record.
fn change(record: &Path, change: impl FnOnce(&mut Value)) {
    let path = record.join("record.json");
    let mut manifest = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    change(&mut manifest);
    fs::write(path, manifest.to_string()).unwrap();
}

#[test]
fn record_of_another_day_is_run_again_to_the_same_bits() {
    let runs = Runs::new();
    let record = runs.run("a", &["--set", "controller.parameters.k_p2=10.5"]);
    let before = fs::read_dir(&record).unwrap().count();
    let (code, printed) = rerun(&record, &[]);
    assert_eq!(code, Some(0), "{printed}");
    assert!(
        printed.ends_with("EQUAL bit for bit\n") && printed.contains("Set differently: nothing"),
        "{printed}"
    );
    assert_eq!(fs::read_dir(&record).unwrap().count(), before, "nothing is added to the record");
}

#[test]
fn rerun_on_another_device_has_the_same_bits_and_names_the_device() {
    let runs = Runs::new();
    let (record, out) = (runs.run("a", &[]), runs.folder("b"));
    let (code, printed) = rerun(&record, &["--device", "native", "--out", out.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("native") && out.join("summary.json").exists(), "{printed}");
}

#[test]
fn changed_build_and_changed_gain_are_named() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    change(&record, |manifest| manifest["versions"]["firmware_build"] = json!("0badc0de"));
    let (code, printed) = rerun(&record, &["--set", "controller.parameters.k_p2=10.5"]);
    assert_eq!(code, Some(1), "{printed}");
    for words in ["firmware_build", "0badc0de", "controller.parameters.k_p2", "First difference: step 0"] {
        assert!(printed.contains(words), "no {words:?} in {printed}");
    }
    assert!(printed.lines().any(|line| line.trim_start().starts_with("parameter  k_p2")), "{printed}");
}

#[test]
fn rerun_in_real_time_judges_what_is_the_same_each_time() {
    let runs = Runs::new();
    let record = runs.run("a", &["--clock", "real-time", "--set", "allow.late=1000"]);
    let (code, printed) = rerun(&record, &[]);
    // A busy machine may be late from the first step on.
    assert_eq!(code, Some(i32::from(printed.contains("nothing can be judged"))), "{printed}");
    assert!(printed.contains("Judged: reference") && printed.contains("Metrics (not judged)"), "{printed}");
}

#[test]
fn replay_on_the_twin_has_equal_torques() {
    let runs = Runs::new();
    let (code, printed) = replay(&runs.run("a", &[]), &["--device", "native"]);
    assert_eq!(code, Some(0), "{printed}");
    assert!(
        printed.contains("200 compared, 0 differ") && printed.ends_with("EQUAL bit for bit\n"),
        "{printed}"
    );
}

#[test]
fn replay_names_the_first_step_and_both_torques() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    change(&record, |manifest| {
        let parameters = manifest["parameters"].as_array_mut().unwrap();
        let gain = parameters.iter_mut().find(|it| it["name"] == "k_p2").unwrap();
        gain["value"] = json!(10.5);
    });
    let (code, printed) = replay(&record, &["--device", "inproc", "--json"]);
    assert_eq!(code, Some(1), "{printed}");
    let result: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(result["first"]["step"], 0, "{result}");
    assert_ne!(result["first"]["recorded_nm"], result["first"]["replayed_nm"], "{result}");
    let largest = (result["largest"]["replayed_nm"].as_f64().unwrap()
        - result["largest"]["recorded_nm"].as_f64().unwrap())
    .abs();
    let within = format!("{}", largest * 1.001);
    assert_eq!(replay(&record, &["--device", "inproc", "--tolerance", &within]).0, Some(0));
}

#[test]
fn what_cannot_be_repeated_is_an_error_that_names_the_reason() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    change(&record, |manifest| manifest["parameters"][3]["name"] = json!("brake_gain"));
    let (code, printed) = replay(&record, &["--device", "inproc"]);
    assert!(code == Some(2) && printed.contains("no parameter brake_gain"), "{code:?}: {printed}");
    change(&record, |manifest| {
        manifest["command_line"] = json!(["lashloop", "run", "a.toml", "--rig=bench.toml"]);
    });
    let (code, printed) = rerun(&record, &[]);
    assert!(code == Some(2) && printed.contains("give --rig RIG.toml"), "{code:?}: {printed}");
    for name in ["run.mcap", "record.json", "scenario.toml"] {
        fs::remove_file(record.join(name)).unwrap();
    }
    for (code, printed) in [rerun(&record, &[]), replay(&record, &["--device", "inproc"])] {
        assert!(code == Some(2) && printed.contains("older format"), "{code:?}: {printed}");
    }
}
