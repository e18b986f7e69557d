//! A plant in another process: its trajectory, its errors and its end.

use std::path::Path;
use std::time::{Duration, Instant};

use lashloop_plant::{Plant, PlantError, PlantValue, PlantValues, Release, Start, smooth};

use super::model;

/// A first line with one signal, at rest where [`release`] starts a plant.
const HELLO: &str = r#"{"lashloop_plant":1,"signals":[{"name":"a_rad","unit":"rad"}],"motor_position_rad":0.5,"load_position_rad":0,"values":[2]}"#;
const STATE: &str = r#"{"motor_position_rad":0,"load_position_rad":0,"values":[1]}"#;

fn values(command: &[&str]) -> PlantValues {
    let mut values = model(None).defaults();
    let text = |word: &&str| PlantValue::Text((*word).to_owned());
    values.insert("command", PlantValue::List(command.iter().map(text).collect()));
    values
}

fn release(values: &PlantValues, folder: &Path) -> Result<Box<dyn Plant>, PlantError> {
    let start = Start::at_rest(0.0, 0.5);
    model(None).release(&Release { values, start, period_s: 1e-3, folder })
}

/// A shell script as the plant. A busy machine may delay its answers.
fn script(text: &str) -> Result<Box<dyn Plant>, PlantError> {
    script_within(text, 30_000)
}

fn script_within(text: &str, step_timeout_ms: i64) -> Result<Box<dyn Plant>, PlantError> {
    let mut values = values(&["sh", "-c", text]);
    values.insert("step_timeout_ms", PlantValue::Integer(step_timeout_ms));
    values.insert("start_timeout_ms", PlantValue::Integer(30_000));
    release(&values, Path::new(""))
}

/// The error of the first step of a script that has sent its first line.
fn error_of_step(rest: &str) -> String {
    let mut plant = script(&format!("read a; echo '{HELLO}'; read b; {rest}")).expect("a first line");
    plant.step(0.0, 1e-3).expect_err("the step fails").to_string()
}

/// The error of one of the first 1000 steps of such a script.
fn error_of_later_step(rest: &str) -> String {
    let mut plant = script(&format!("read a; echo '{HELLO}'; read b; {rest}")).expect("a first line");
    let error = (0..1000).find_map(|_| {
        // The time of a drive's answer.
        std::thread::sleep(Duration::from_millis(1));
        plant.step(0.0, 1e-3).err()
    });
    error.expect("a step fails").to_string()
}

#[test]
fn the_python_example_moves_as_the_smooth_plant_does() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plant-process");
    let mut values = values(&["python3", "plant.py"]);
    // A busy machine may delay an answer.
    values.insert("step_timeout_ms", PlantValue::Integer(30_000));
    let mut process = release(&values, &folder).expect("python3 and the example");
    let model = smooth::model();
    let start = Start::at_rest(0.0, 0.5);
    let defaults = model.defaults();
    let release = Release { values: &defaults, start, period_s: 1e-3, folder: Path::new("") };
    let mut native = model.release(&release).expect("the smooth plant");
    let shared = ["twist_rad", "transmitted_torque_nm", "dead_zone_rad"];
    let names: Vec<_> = process.signals().iter().map(|signal| signal.name.to_string()).collect();
    assert_eq!(names, shared);
    let mut truths = [vec![0.0; 3], vec![0.0; native.signals().len()]];
    for k in 0..500 {
        let torque_nm = if k % 200 < 100 { 1.5 } else { -1.0 };
        for plant in [&mut process, &mut native] {
            plant.step(torque_nm, 1e-3).expect("a step");
        }
        let (have, want) = (process.positions(), native.positions());
        // The same method and substeps; tanh and the order of additions differ in the last bits.
        let off_rad = (have.motor_position_rad - want.motor_position_rad)
            .abs()
            .max((have.load_position_rad - want.load_position_rad).abs());
        assert!(off_rad <= 1e-11, "{off_rad} rad after {k} ms");
        process.truth(&mut truths[0]);
        native.truth(&mut truths[1]);
        for (at, name) in shared.iter().enumerate() {
            let other = native.signals().iter().position(|signal| signal.name == *name).expect(name);
            assert!((truths[0][at] - truths[1][other]).abs() <= 1e-11, "{name} after {k} ms");
        }
    }
}

#[test]
fn settings_and_initial_state_reach_the_process() {
    let echo = r#"read a; echo "$a" >&2; exit 1"#;
    let mut values = values(&["sh", "-c", echo]);
    let settings =
        [("teeth".to_owned(), PlantValue::Integer(17)), ("wet".to_owned(), PlantValue::Boolean(true))];
    values.insert("settings", PlantValue::Table(settings.into()));
    let error = release(&values, Path::new("")).err().expect("the process ends").to_string();
    let sent = r#"{\"lashloop_plant\":1,\"period_s\":0.001,\"initial\":{\"load_position_rad\":0.0,"#;
    assert!(error.contains(sent), "{error}");
    assert!(error.contains(r#"\"settings\":{\"teeth\":17,\"wet\":true}}"#), "{error}");
}

#[test]
fn truth_is_that_of_the_last_line() {
    let mut plant =
        script(&format!("read a; echo '{HELLO}'; read b; echo '{STATE}'; read c")).expect("a plant");
    let mut truth = [0.0];
    plant.truth(&mut truth);
    assert_eq!((truth, plant.positions().motor_position_rad), ([2.0], 0.5));
    plant.step(0.0, 1e-3).expect("a step");
    plant.truth(&mut truth);
    assert_eq!((truth, plant.positions().motor_position_rad), ([1.0], 0.0));
}

#[test]
fn far_from_zero_a_start_in_single_precision_passes() {
    let start_m_rad = 4_000.123_456_789;
    let start = |have: f64| {
        let hello = HELLO.replace("0.5", &have.to_string());
        let values = values(&["sh", "-c", &format!("read a; echo '{hello}'; read b")]);
        let start = Start::at_rest(0.0, start_m_rad);
        model(None).release(&Release { values: &values, start, period_s: 1e-3, folder: Path::new("") })
    };
    assert!(start(f64::from(start_m_rad as f32)).is_ok());
    let error = start(start_m_rad + 0.01).err().expect("another start").to_string();
    assert!(error.contains("and plant.initial.motor_position_rad is 4000.12"), "{error}");
}

#[test]
fn errors_of_a_process_name_the_cause_and_the_remedy() {
    let start = |text: &str| script(text).err().expect(text).to_string();
    let two = STATE.replace("[1]", "[1, 2]");
    let infinite = STATE.replace("[1]", "[NaN]");
    let mut plant = script_within(&format!("read a; echo '{HELLO}'; sleep 30"), 300).expect("a first line");
    let hanging = plant.step(0.0, 1e-3).expect_err("a limit").to_string();
    let cases = [
        (start("echo oops >&2; exit 3"), "ended in the middle of the run: exit status: 3; it wrote \"oops\""),
        (error_of_step("exit 0"), "the plant's process ended"),
        (hanging.clone(), "wrote no line within 300 ms; it must write one for each line that it reads"),
        (hanging, "set plant.step_timeout_ms"),
        (
            error_of_step("echo hello"),
            "wrote \"hello\": expected value at line 1 column 1; standard output is for",
        ),
        (error_of_step(&format!("echo '{two}'")), "sent 2 values for its 1 signals"),
        (error_of_step(&format!("echo '{infinite}'")), "with a number that is not finite"),
        (error_of_step("echo 'info: ready'"), "wrote \"info: ready\": expected value at line 1"),
        (error_of_step("echo '{\"error\": \"the belt slips\"}'"), "reports: the belt slips"),
        (
            start(&format!("read a; echo '{}'", HELLO.replace("0.5", "0.25"))),
            "starts with motor_position_rad = 0.25, and plant.initial.motor_position_rad is 0.5; a process that can't start",
        ),
        (start("read a; echo '{\"lashloop_plant\": 2}'"), "has version 2 of the protocol, the bench has 1"),
    ];
    for (have, want) in cases {
        assert!(have.contains(want), "have {have}\nwant {want}");
    }
    let missing = values(&["no-such-plant"]);
    let error = release(&missing, Path::new("")).err().expect("no program").to_string();
    assert!(error.contains("no program no-such-plant in PATH") && error.contains("plant.command"), "{error}");
}

#[test]
fn texts_of_a_process_do_not_control_a_terminal() {
    let hello = HELLO.replace("a_rad", r"a\u001b[2J_rad").replace(r#""unit":"rad""#, r#""unit":"\u0007""#);
    let plant = script(&format!("read a; printf '%s\\n' '{hello}'; read b")).expect("a first line");
    let signal = &plant.signals()[0];
    assert_eq!((&*signal.name, &*signal.unit), (r"a\u{1b}[2J_rad", r"\u{7}"));
    let error = error_of_step(r#"printf '%s\n' '{"error": "a\u001b[2J"}'"#);
    assert!(error.ends_with(r"reports: a\u{1b}[2J"), "{error}");
}

#[test]
fn a_process_that_reads_nothing_fails_within_its_time() {
    // More than a pipe holds.
    let mut values = values(&["sleep", "30"]);
    values.insert("start_timeout_ms", PlantValue::Integer(300));
    let settings = [("notes".to_owned(), PlantValue::Text("x".repeat(1 << 18)))];
    values.insert("settings", PlantValue::Table(settings.into()));
    let started = Instant::now();
    let error = release(&values, Path::new("")).err().expect("a process that is not ready").to_string();
    assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());
    assert!(error.contains("did not read its line within 300 ms"), "{error}");
    assert!(error.contains("set plant.start_timeout_ms"), "{error}");
}

#[test]
fn a_line_without_a_step_is_an_error_instead_of_a_lag() {
    let error = error_of_later_step(&format!(
        "echo '{STATE}'; echo '{STATE}'; while read c; do echo '{STATE}'; done"
    ));
    assert!(error.contains("without a step for it"), "{error}");
    assert!(error.contains(r#"wrote "{\"motor_position_rad\":0,"#), "{error}");
    // The extra line follows later, and the steps continue in the meantime.
    let late = format!("echo '{STATE}'; while read c; do echo '{STATE}'; sleep 0.01; echo '{STATE}'; done");
    let error = error_of_later_step(&late);
    assert!(error.contains("without a step for it"), "{error}");
}

#[test]
fn a_dropped_plant_leaves_no_process() {
    let name = format!("process_plant_that_hangs_{}", std::process::id());
    // Deaf to the end of its input, with a child of its own.
    let text = format!("read a; echo '{HELLO}'; sleep 1000; : {name}");
    let plant = script(&text).expect("a plant");
    let running = || {
        let processes = std::fs::read_dir("/proc").expect("a list of processes");
        let lines = processes.filter_map(|entry| std::fs::read(entry.ok()?.path().join("cmdline")).ok());
        lines.filter(|line| String::from_utf8_lossy(line).contains(&name)).count()
    };
    // The shell, and for an instant its child before `sleep` takes its place.
    assert!(running() > 0);
    drop(plant);
    let deadline = Instant::now() + Duration::from_secs(5);
    while running() > 0 {
        assert!(Instant::now() < deadline, "the process still runs");
        std::thread::yield_now();
    }
}
