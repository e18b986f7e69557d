//! Exit codes of runs.

use rustix::process::Signal;
use serde_json::json;
use tests::loss::run_in_progress;
use tests::paper::PATIENCE;
use tests::program;
use tests::records::Records;
use tests::relay::{Action, Relay};
use tests::twin::Twin;

#[test]
fn a_missed_expectation_fails_with_exit_code_1() {
    let records = Records::new();
    let out = records.out();
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", "native", "--out", &out];
    let settings = ["--set", "expect.0.min=1", "--set", "expect.0.max=4.5"];
    let ended = program::run(arguments.into_iter().chain(settings).chain(PATIENCE)).with_code(1);
    assert!(ended.stdout.contains("MISSED settle_time_s: 5.104 s; misses 1 to 4.5 s"), "{}", ended.stdout);
    assert!(ended.stdout.starts_with("FAIL  "), "{}", ended.stdout);
    assert_eq!(ended.messages(), [""; 0]);
    let summary = records.summary();
    assert_eq!((&summary["verdict"], &summary["expectations"][0]["ok"]), (&"FAIL".into(), &false.into()));
}

#[test]
fn a_latched_fault_fails_the_run_with_its_reason() {
    let records = Records::new();
    let out = records.out();
    let limit = "controller.parameters.motor_speed_limit_rad_s=2";
    let ended = program::run([
        "run",
        "scenarios/smooth-after.toml",
        "--device",
        "native",
        "--out",
        &out,
        "--set",
        limit,
    ])
    .with_code(1);
    assert!(
        ended.stdout.contains("ENDED  the drive latched MotorEncoderJump at sample "),
        "{}",
        ended.stdout
    );
    let summary = records.summary();
    assert_eq!(summary["verdict"], "FAIL");
    assert_eq!(summary["steps"].as_u64(), Some(records.trace().len() as u64));
}

#[test]
fn a_torque_beyond_the_limit_fails_the_run_with_rule_and_step() {
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| match frame.torque() {
        Some(mut answer) if answer.sequence == 300 => {
            answer.torque_nm = 25.0_f32.next_up();
            frame.replaced(answer)
        }
        _ => Action::Forward,
    });
    let records = Records::new();
    let arguments =
        ["run", "scenarios/smooth-after.toml", "--device", relay.device(), "--out", &records.out()];
    let ended = program::run(arguments.into_iter().chain(PATIENCE)).with_code(1);
    let end = "the drive breaks rule R7.11 of docs/protocol.md at step 300, sequence 300: torque 25.000002 N m, limit: \
               25 N m; a torque lies within torque_limit_nm";
    assert!(ended.stdout.starts_with("FAIL  "), "{}", ended.stdout);
    assert!(ended.stdout.contains(&format!("\nENDED  {end}\n")), "{}", ended.stdout);
    let summary = records.summary();
    assert_eq!((&summary["verdict"], &summary["end"]), (&"FAIL".into(), &end.into()));
    let broken = json!({
        "side": "drive",
        "rule": "R7.11",
        "requirement": "a torque lies within torque_limit_nm",
        "step": 300,
        "sequence": 300,
        "value": "torque 25.000002 N m",
        "limit": "25 N m",
    });
    assert_eq!(summary["broken_rule"], broken);
    assert_eq!(
        records.trace().column("torque_nm").last(),
        Some(&0.0),
        "the motor gets no torque of this drive"
    );
}

#[test]
fn an_interrupted_run_is_invalid_and_leaves_readable_records() {
    for (device, signal) in [("native", Signal::INT), ("native", Signal::TERM), ("inproc", Signal::INT)] {
        let (bench, records) = run_in_progress(device);
        bench.signal(signal);
        let ended = bench.wait().with_code(3);
        assert!(ended.stdout.starts_with("INVALID  "), "{}", ended.stdout);
        assert!(ended.stdout.contains("\nENDED  interrupted by the user\n"), "{}", ended.stdout);
        let summary = records.summary();
        assert_eq!(
            (&summary["verdict"], &summary["end"]),
            (&"INVALID".into(), &"interrupted by the user".into()),
            "{device}"
        );
        assert_eq!(summary["steps"].as_u64(), Some(records.trace().len() as u64), "{device}");
    }
}
