//! Bad usage: exit code 2, and a message with place, error and alternative.

use std::fmt::Write;
use std::fs;

use tests::program;
use tests::records::Records;

const SCENARIO: &str = "scenarios/smooth-after.toml";

/// A scenario with fixed line numbers.
const MINE: &str = r#"title = "Mine"

[run]
duration_s = 25.0

[plant]
model = "smooth"

[controller]
name = "merzouki"

[controller.parameters]
torque_limit_nm = 25.0

[reference]
profile = "constant"
position_rad = 0.0
"#;

#[test]
fn every_wrong_command_line_says_what_instead() {
    let run = |rest: &[&'static str]| [&["run", SCENARIO, "--device", "inproc"], rest].concat();
    let mut messages = String::new();
    for arguments in [
        run(&["--set", "plant.stifness_nm_rad=2"]),
        run(&["--set", "plant.stiffness_nm_rad"]),
        run(&["--set", "plant.stiffness_nm_rad=-1"]),
        run(&["--set", "run.duration_s=long"]),
        run(&["--set", "controller.parameters.torque_limit_nm=2000"]),
        run(&["--set", "controller.parameters.k_p9=1"]),
        run(&["--set", "link.answer_timeout_ms=60000"]),
        run(&["--controller", "lqr"]),
        run(&["--out", "Cargo.toml/out"]),
        run(&["--device", "banana"]),
        vec!["run", SCENARIO, "--device", "banana"],
        vec!["run", SCENARIO, "--device", "qemu:"],
        vec!["run", "scenarios/none.toml"],
        vec!["run", "scenarios"],
        vec!["run", "README"],
        vec!["run"],
        vec!["runn", SCENARIO],
        vec![],
    ] {
        let ended = program::run(&arguments).with_code(2);
        assert_eq!(ended.stdout, "", "{arguments:?}");
        writeln!(messages, "$ lashloop {}\n{}", arguments.join(" "), ended.stderr)
            .expect("writing to a string");
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn what_a_scenario_file_has_wrong_is_named_by_file_and_line() {
    let records = Records::new();
    let file = records.path("mine.toml");
    let path = file.display().to_string();
    let mut messages = String::new();
    for (right, wrong) in [
        ("torque_limit_nm = 25.0", "torque_limit_nm = 2000.0"),
        ("torque_limit_nm = 25.0", "torque_limit_Nm = 25.0"),
        ("torque_limit_nm = 25.0", "watchdog_us = 70000000"),
        ("torque_limit_nm = 25.0", "period_us = 500"),
        ("duration_s = 25.0", "duration = 25.0"),
        ("name = \"merzouki\"", "name = \"faithfull\""),
        ("[plant]", "[plant"),
    ] {
        assert!(MINE.contains(right), "{right} is not in the scenario");
        fs::write(&file, MINE.replace(right, wrong)).expect("a scenario of the test");
        let ended = program::run(["run", &path, "--device", "inproc"]).with_code(2);
        let message = ended.stderr.replace(&path, "mine.toml");
        writeln!(messages, "{right} -> {wrong}\n{message}").expect("writing to a string");
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn benchmark_refuses_a_missing_core() {
    let ended = program::run(["benchmark", "--core", "1023"]).with_code(2);
    assert!(ended.stderr.contains("--core 1023 can't be used"), "{}", ended.stderr);
}
