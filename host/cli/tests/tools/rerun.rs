//! `lashloop rerun` and `lashloop replay` on the records of `lashloop run`.

use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};

use crate::diff::Runs;
use crate::samples;
use crate::support::{LASHLOOP, lashloop, root, text};

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
    change(&record, |manifest| {
        manifest["versions"]["firmware_build"] = json!("0badc0de\u{1b}[2J");
        manifest["started"] = json!("\u{9b}31m");
    });
    let (code, printed) = rerun(&record, &["--set", "controller.parameters.k_p2=10.5"]);
    assert_eq!(code, Some(1), "{printed}");
    for words in ["firmware_build", "0badc0de", "controller.parameters.k_p2", "First difference: step 0"] {
        assert!(printed.contains(words), "no {words:?} in {printed}");
    }
    assert!(printed.lines().any(|line| line.trim_start().starts_with("parameter  k_p2")), "{printed}");
    assert!(!printed.contains(['\u{1b}', '\u{9b}']), "a record controls the terminal: {printed:?}");
}

/// A process that ends with the test.
struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn device_with_a_relative_path_is_found_from_another_folder() {
    let runs = Runs::new();
    let drive = Command::new(LASHLOOP).arg("device").stdout(Stdio::piped()).spawn();
    let mut drive = Killed(drive.unwrap());
    let mut terminal = String::new();
    BufReader::new(drive.0.stdout.take().unwrap()).read_line(&mut terminal).unwrap();
    symlink(terminal.trim(), runs.folder("drive")).unwrap();
    let mut run = Command::new(LASHLOOP);
    run.current_dir(runs.folder(".")).arg("run").arg(root().join("scenarios/smooth-after.toml"));
    run.args(["--device", "./drive", "--out", "a", "--set", "run.duration_s=0.2", "--set", "expect=[]"]);
    let ended = run.output().unwrap();
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    let (code, printed) = rerun(&runs.folder("a"), &["--trust", "--out", runs.folder("b").to_str().unwrap()]);
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("Set differently: nothing"), "{printed}");
}

#[test]
fn rerun_in_real_time_judges_what_is_the_same_each_time() {
    let runs = Runs::new();
    let options = ["--clock", "real-time", "--spin-us=30", "--core", "0", "--set", "allow.late=1000"];
    let (record, again) = (runs.run("a", &options), runs.folder("b"));
    // Options come from their entries: the command line is a text for people.
    change(&record, |manifest| manifest["command_line"] = json!([]));
    let (code, printed) = rerun(&record, &["--out", again.to_str().unwrap()]);
    let manifest: Value = serde_json::from_slice(&fs::read(again.join("record.json")).unwrap()).unwrap();
    let real_time = json!({ "spin_us": 30, "fifo": null, "lock_memory": false, "core": 0 });
    assert_eq!(manifest["real_time"], real_time);
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
    assert_eq!((&result["agreement"], &result["end"]), (&json!("different"), &Value::Null), "{result}");
    assert_eq!(result["first"]["step"], 0, "{result}");
    assert_ne!(result["first"]["recorded_nm"], result["first"]["replayed_nm"], "{result}");
    let largest = (result["largest"]["replayed_nm"].as_f64().unwrap()
        - result["largest"]["recorded_nm"].as_f64().unwrap())
    .abs();
    let within = format!("{}", largest * 1.001);
    assert_eq!(replay(&record, &["--device", "inproc", "--tolerance", &within]).0, Some(0));
}

#[test]
fn fault_of_a_replay_is_in_its_json() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    change(&record, |manifest| {
        let parameters = manifest["parameters"].as_array_mut().unwrap();
        parameters.iter_mut().find(|it| it["name"] == "motor_speed_limit_rad_s").unwrap()["value"] =
            json!(0.1);
    });
    let (code, printed) = replay(&record, &["--device", "inproc", "--json"]);
    assert_eq!(code, Some(1), "{printed}");
    let result: Value = serde_json::from_str(&printed).unwrap();
    let end = &result["end"];
    assert_eq!((&result["agreement"], &end["kind"]), (&json!("different"), &json!("fault")), "{result}");
    assert_eq!(end["code"], "MotorEncoderJump", "{result}");
    assert!(end["step"].as_u64() > Some(0) && end["limit"].is_f64(), "{result}");
}

#[test]
fn replay_of_an_interrupted_run_names_what_is_not_recorded() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    assert!(!replay(&record, &["--device", "inproc"]).1.contains("restarted"));
    fs::remove_file(record.join("summary.json")).unwrap();
    let (code, printed) = replay(&record, &["--device", "inproc"]);
    assert!(code == Some(0) && printed.contains("does not show whether its drive was lost"), "{printed}");
}

#[test]
fn plant_in_a_process_runs_where_it_ran_and_its_change_is_named() {
    let runs = Runs::new();
    let (lab, out) = (runs.folder("lab"), runs.folder("a"));
    fs::create_dir(&lab).unwrap();
    for name in ["plant.toml", "plant.py"] {
        fs::copy(root().join("examples/plant-process").join(name), lab.join(name)).unwrap();
    }
    let scenario = lab.join("plant.toml");
    let [scenario, folder] = [&scenario, &out].map(|path| path.to_str().unwrap());
    let short = ["--set", "run.duration_s=0.1"];
    let ended =
        lashloop(&[&["run", scenario, "--device", "inproc", "--out", folder][..], &short].concat(), &[]);
    assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    let (code, printed) = rerun(&out, &["--trust"]);
    assert!(code == Some(0) && printed.contains("Set differently: nothing"), "{code:?}: {printed}");
    let plant = fs::read_to_string(lab.join("plant.py")).unwrap();
    fs::write(lab.join("plant.py"), plant.replace("\"f_s\": 16.0", "\"f_s\": 17.0")).unwrap();
    let (code, printed) = rerun(&out, &["--trust"]);
    assert_eq!(code, Some(1), "{printed}");
    assert!(printed.contains("sha256 of plant.py") && printed.contains("First difference"), "{printed}");
}

#[test]
fn record_of_a_part_is_compared_with_this_part() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    // Rows from 0.05 s to 0.149 s, as a soak keeps them.
    samples::rewrite(&record, |message| (50..150).contains(&samples::step(message)));
    let options = ["--only", "load_position_rad"];
    let (code, printed) = rerun(&record, &options);
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("from 0.050000 s to 0.149000 s"), "{printed}");
    assert!(printed.contains("Rows compared: 100\n"), "{printed}");
    let (code, printed) =
        rerun(&record, &[&options[..], &["--set", "controller.parameters.k_p2=1"]].concat());
    assert_eq!(code, Some(1), "{printed}");
}

#[test]
fn what_cannot_be_repeated_is_an_error_that_names_the_reason() {
    let runs = Runs::new();
    let record = runs.run("a", &[]);
    let out = runs.folder("b");
    let (code, printed) = rerun(&record, &["--tolerance", "nope=1", "--out", out.to_str().unwrap()]);
    let names_it = printed.contains("nope: the comparison has no signal or metric");
    assert!(code == Some(2) && names_it && !out.exists(), "{code:?}: {printed}");
    change(&record, |manifest| manifest["parameters"][3]["name"] = json!("brake_gain"));
    let (code, printed) = replay(&record, &["--device", "inproc"]);
    assert!(code == Some(2) && printed.contains("no parameter brake_gain"), "{code:?}: {printed}");
    change(&record, |manifest| manifest["rig"] = json!("bench.toml"));
    let (code, printed) = rerun(&record, &[]);
    assert!(code == Some(2) && printed.contains("give --rig 'bench.toml'"), "{code:?}: {printed}");
    for name in ["scenario.toml", "run.mcap", "record.json"] {
        fs::remove_file(record.join(name)).unwrap();
        for (code, printed) in [rerun(&record, &[]), replay(&record, &["--device", "inproc"])] {
            let names_it =
                printed.contains(name) || (name == "record.json" && printed.contains("holds no record"));
            assert!(code == Some(2) && names_it, "{code:?}: {printed}");
        }
    }
}
