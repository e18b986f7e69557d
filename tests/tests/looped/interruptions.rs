//! SIGINT at moments without a run: the program says so and ends as INVALID, at once.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::Signal;
use tests::program::{self, Running};
use tests::twin::Twin;
use tests::{processes, wait};

const SCENARIO: &str = "scenarios/smooth-after.toml";
/// A second, and as much again twice for a busy machine.
const LIMIT: Duration = Duration::from_secs(3);

/// Interrupts the program; its standard error.
fn interrupted(bench: Running) -> String {
    let sent = Instant::now();
    bench.signal(Signal::INT);
    let ended = bench.wait().with_code(3);
    assert!(ended.at - sent < LIMIT, "took {:?}", ended.at - sent);
    assert!(ended.stderr.contains("INVALID: interrupted by the user"), "{}", ended.stderr);
    ended.stderr
}

#[test]
fn an_interruption_before_the_handshake_is_invalid() {
    for command in ["run", "conformance", "parameters", "doctor"] {
        let device = "exec:sleep 100";
        let arguments = match command {
            "run" => vec!["run", SCENARIO, "--device", device],
            "parameters" => vec!["parameters", "list", "--device", device],
            "doctor" => vec!["doctor", device],
            other => vec![other, "--device", device],
        };
        let bench = Running::start(arguments);
        wait::until("the drive has started", || (!processes::children(bench.id()).is_empty()).then_some(()));
        let _ = interrupted(bench);
    }
}

/// The check that waits for a drive without an answer has no result: it neither failed nor passed.
#[test]
fn an_interruption_ends_the_wait_of_a_conformance_check() {
    let twin = Twin::start();
    let junit = tempfile::NamedTempFile::new().expect("a file");
    let printed = tempfile::NamedTempFile::new().expect("a file");
    let results = || fs::read_to_string(printed.path()).expect("the results");
    let mut bench = Command::new(program::lashloop())
        .args(["conformance", "--device", &twin.device(), "--junit"])
        .arg(junit.path())
        .stdout(printed.reopen().expect("a file"))
        .spawn()
        .expect("lashloop");
    wait::until("the first check has passed", || results().contains("PASS").then_some(()));
    twin.signal(Signal::STOP);
    let sent = Instant::now();
    processes::signal(bench.id(), Signal::INT);
    let ended = wait::until("it has ended", || bench.try_wait().expect("a process"));
    assert!(sent.elapsed() < LIMIT, "took {:?}", sent.elapsed());
    assert_eq!(ended.code(), Some(3), "{}", results());
    assert!(results().contains(" 0 failed, "), "{}", results());
    assert!(results().contains("; interrupted, the rest was not run"), "{}", results());
    let report = fs::read_to_string(junit.path()).expect("the report");
    assert!(report.contains("the run ended early: interrupted"), "{report}");
}

/// Whether the program handles signals by now.
fn is_ready(id: u32) -> bool {
    let names = fs::read_dir(format!("/proc/{id}/task")).into_iter().flatten().flatten();
    names
        .map(|task| fs::read_to_string(task.path().join("comm")))
        .any(|it| it.is_ok_and(|it| it == "signals\n"))
}

#[test]
fn an_interrupted_command_without_a_run_is_invalid() {
    let mut command = Command::new(program::lashloop());
    let mut decode =
        command.args(["decode", "-"]).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("lashloop");
    wait::until("it handles signals", || is_ready(decode.id()).then_some(()));
    processes::signal(decode.id(), Signal::INT);
    let ended = wait::until("it has ended", || decode.try_wait().expect("a process"));
    let stderr = std::io::read_to_string(decode.stderr.take().expect("a pipe")).expect("a text");
    assert_eq!(
        (ended.code(), stderr.contains("INVALID: interrupted by the user")),
        (Some(3), true),
        "{stderr}"
    );
}

#[test]
fn an_interruption_while_a_plant_starts_does_not_blame_the_plant() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = folder.path().join("slow.toml");
    let plant = "[plant]\nmodel = \"process\"\ncommand = [\"sleep\", \"1000\"]\nstart_timeout_ms = 600000\n";
    fs::write(
        &scenario,
        format!("title = \"slow\"\nrun = {{ duration_s = 1.0 }}\ncontroller = {{ name = \"pd\" }}\n{REFERENCE}{plant}"),
    )
    .expect("a scenario");
    let bench = Running::start([Path::new("run"), &scenario, Path::new("--device"), Path::new("inproc")]);
    wait::until("the plant has started", || (!processes::children(bench.id()).is_empty()).then_some(()));
    let stderr = interrupted(bench);
    assert!(!stderr.contains("wrote no line"), "{stderr}");
}

#[test]
fn an_interruption_while_a_plant_computes_a_step_is_invalid() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = folder.path().join("slow.toml");
    let answer = r#"{"lashloop_plant":1,"signals":[],"motor_position_rad":0.0,"load_position_rad":0.0}"#;
    let program = format!("read hello; echo '{answer}'; read step; touch \"$0\"; sleep 1000");
    let begun = folder.path().join("begun");
    let plant = format!(
        "[plant]\nmodel = \"process\"\ncommand = [\"sh\", \"-c\", {program:?}, {begun:?}]\nstep_timeout_ms = 600000\n\
         [plant.initial]\nmotor_position_rad = 0.0\nload_position_rad = 0.0\n"
    );
    fs::write(
        &scenario,
        format!("title = \"slow\"\nrun = {{ duration_s = 1.0 }}\ncontroller = {{ name = \"pd\" }}\n{REFERENCE}{plant}"),
    )
    .expect("a scenario");
    let bench = Running::start([Path::new("run"), &scenario, Path::new("--device"), Path::new("inproc")]);
    wait::until("the plant computes", || begun.exists().then_some(()));
    bench.signal(Signal::INT);
    let ended = bench.wait().with_code(3);
    assert!(ended.stdout.starts_with("INVALID "), "{}", ended.stdout);
}

const REFERENCE: &str = "reference = { profile = \"constant\", position_rad = 0.0 }\n";
