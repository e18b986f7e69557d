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
    assert!(short.starts_with("PASS  ") && long.starts_with("PASS  "), "{short}{long}");
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
