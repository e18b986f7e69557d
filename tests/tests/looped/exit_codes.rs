//! Exit codes of runs.

use rustix::process::Signal;
use tests::loss::run_in_progress;
use tests::paper::PATIENCE;
use tests::program;
use tests::records::Records;

#[test]
fn a_missed_expectation_fails_with_exit_code_1() {
    let records = Records::new();
    let out = records.out();
    let arguments = ["run", "scenarios/smooth-after.toml", "--device", "native", "--out", &out];
    let settings = ["--set", "expect.0.min=1", "--set", "expect.0.max=4.5"];
    let ended = program::run(arguments.into_iter().chain(settings).chain(PATIENCE)).with_code(1);
    assert!(ended.stdout.contains("MISSED settle_time_s: 5.104 s; misses 1 to 4.5 s"), "{}", ended.stdout);
    assert!(ended.stdout.ends_with("FAIL\n"), "{}", ended.stdout);
    assert_eq!(ended.stderr, "");
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
fn an_interrupted_run_is_invalid_and_leaves_readable_records() {
    for (device, signal) in [("native", Signal::INT), ("native", Signal::TERM), ("inproc", Signal::INT)] {
        let (bench, records) = run_in_progress(device);
        bench.signal(signal);
        let ended = bench.wait().with_code(3);
        assert!(ended.stdout.ends_with("ENDED  interrupted by the user\nINVALID\n"), "{}", ended.stdout);
        let summary = records.summary();
        assert_eq!(
            (&summary["verdict"], &summary["end"]),
            (&"INVALID".into(), &"interrupted by the user".into()),
            "{device}"
        );
        assert_eq!(summary["steps"].as_u64(), Some(records.trace().len() as u64), "{device}");
    }
}
