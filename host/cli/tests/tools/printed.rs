//! What commands print: verdict first, JSON alone, events of the line.

use std::process::{Command, Output};

use crate::support::{LASHLOOP, root, text};

/// A run of 0.1 s in process with these arguments and this `RUST_LOG`.
fn run(arguments: &[&str], log: Option<&str>) -> Output {
    let mut command = Command::new(LASHLOOP);
    command.arg("run").arg(root().join("scenarios/faults.toml")).args(["--device", "inproc"]);
    command
        .args(["--set", "run.duration_s=0.1", "--set", "expect=[]"])
        .args(arguments)
        .env_remove("RUST_LOG");
    let output = command.envs(log.map(|filter| ("RUST_LOG", filter))).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    output
}

#[test]
fn a_run_prints_its_verdict_first_and_the_rest_on_request() {
    let (short, long) = (run(&[], None), run(&["--details"], None));
    let (short, long) = (text(&short.stdout), text(&long.stdout));
    assert!([short, long].iter().all(|it| it.starts_with("PASS, nothing expected  ")), "{short}{long}");
    for line in ["link  ", "timing  ", "torque  ", "no value  "] {
        assert!(!short.contains(&format!("\n{line}")), "{line} in {short}");
        assert!(long.contains(&format!("\n{line}")), "no {line} in {long}");
    }
}

#[test]
fn a_run_as_json_is_the_summary_and_nothing_else() {
    let output = run(&["--json"], None);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&summary["verdict"], &summary["steps"]), (&"PASS".into(), &100.into()));
}

#[test]
fn events_are_printed_on_request_and_rust_log_chooses_them() {
    let handshake = "the drive completed the handshake";
    let has = |output: Output| text(&output.stderr).contains(handshake);
    assert!(!has(run(&[], None)));
    assert!(has(run(&["-v"], None)));
    assert!(has(run(&[], Some("info"))));
    assert!(!has(run(&["-v"], Some("lashloop_session=off,info"))));
}

#[test]
fn the_version_has_the_build() {
    let output = Command::new(LASHLOOP).arg("--version").output().unwrap();
    let version = text(&output.stdout);
    assert!(version.starts_with(concat!("lashloop ", env!("CARGO_PKG_VERSION"), " (build ")), "{version}");
}

#[test]
fn a_pass_of_a_run_of_which_nothing_was_expected_says_so() {
    let printed = run(&[], None);
    let note = "\nnote   no [[expect]] judges the drive\n";
    assert!(text(&printed.stdout).contains(note), "{}", text(&printed.stdout));
    let expects = "expect=[{ metric = 'peak_torque_nm', unit = 'N m', max = 20.0 }]";
    let printed = run(&["--set", expects], None);
    assert!(!text(&printed.stdout).contains("nothing expected"), "{}", text(&printed.stdout));
}

/// The exit code of a command, and its errors.
fn refused(arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(LASHLOOP).current_dir(root()).args(arguments).output().unwrap();
    (output.status.code(), text(&output.stderr).to_owned())
}

#[test]
fn a_core_that_the_process_may_not_run_on_is_an_error_before_the_run() {
    let run =
        ["run", "scenarios/faults.toml", "--device", "inproc", "--clock", "real-time", "--core", "1023"];
    let (code, message) = refused(&run);
    assert_eq!(code, Some(2), "{message}");
    assert!(message.contains("--core 1023 can't be used: this process may run on core"), "{message}");
}

#[test]
fn a_suite_refuses_cases_of_which_nothing_is_expected_if_it_is_asked_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let text = std::fs::read_to_string(root().join("scenarios/smooth-after.toml")).unwrap();
    let (bare, _) = text.split_once("[[expect]]").unwrap();
    std::fs::write(path("judged.toml"), &text).unwrap();
    std::fs::write(path("bare.toml"), bare).unwrap();
    let folder = folder.path().display().to_string();
    let suite = |more: &[&str]| {
        let arguments = [&["test", &*folder, "--device", "inproc"], more].concat();
        let output = Command::new(LASHLOOP).args(arguments).output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, table) = suite(&[]);
    assert!(code == Some(0) && table.contains("bare.toml    none expected"), "{table}");
    let junit = tempfile::NamedTempFile::new().unwrap();
    suite(&["--junit", &junit.path().display().to_string()]);
    let xml = std::fs::read_to_string(junit.path()).unwrap();
    assert_eq!(xml.matches(r#"<property name="expectations" value="none"/>"#).count(), 1, "{xml}");
    let (code, table) = suite(&["--require-expectations"]);
    assert!(code == Some(2) && table.contains("1 PASS, 0 FAIL, 0 INVALID, 1 ERROR"), "{table}");
    assert!(table.contains("bare.toml: nothing is expected of it; give it an [[expect]]"), "{table}");
    let (code, table) = suite(&["--require-expectations", "--dry-run"]);
    assert!(code == Some(2) && table.contains("bare.toml:1:1: nothing is expected of it"), "{table}");
    assert_eq!(suite(&["--dry-run"]), (Some(0), String::new()));
}

#[test]
fn too_few_descriptors_are_an_error_at_every_number() {
    for most in 6..24 {
        let line = format!("ulimit -n {most}; exec \"$0\" run scenarios/faults.toml --device inproc");
        let command = ["-c", &line, LASHLOOP];
        let output = Command::new("sh").current_dir(root()).args(command).output().unwrap();
        // A panic has code 101.
        let code = output.status.code();
        assert!(matches!(code, Some(0..=4)), "{most} descriptors: {code:?}, {}", text(&output.stderr));
    }
}
