//! Runs beyond the range of the numbers on the wire: sequences of 16 bits, counts of 24 bits.

use std::fs;

use tests::paper::PATIENCE;
use tests::program;
use tests::records::Records;
use tests::workspace;

const SCENARIO: &str = "scenarios/shaft-backlash-inverse.toml";
/// Steps of 1 ms, beyond the 65,536th.
const STEPS: usize = 70_000;

fn run(scenario: &str, records: &Records, settings: &[&str], code: i32) -> program::Ended {
    let out = records.out();
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    let arguments = ["run", scenario, "--device", "inproc", "--out", &out].into_iter().chain(settings);
    program::run(arguments.chain(["--set", "expect=[]"]).chain(PATIENCE)).with_code(code)
}

#[test]
fn steps_count_on_through_a_wraparound_of_sequences() {
    const EVERY: usize = 10;
    let records = Records::new();
    let _ = run(SCENARIO, &records, &["run.duration_s=70"], 0);
    let summary = records.summary();
    let link = &summary["link"];
    assert_eq!((&summary["steps"], &summary["verdict"]), (&STEPS.into(), &"PASS".into()));
    assert_eq!((&link["lost"], &link["late"]), (&0.into(), &0.into()));
    let trace = records.trace();
    let (time_s, telemetry_time_s) = (trace.column("time_s"), trace.column("telemetry_time_s"));
    assert_eq!(time_s.len(), STEPS);
    for (step, telemetry_time_s) in telemetry_time_s.iter().enumerate() {
        // Telemetry follows the torques whose sequence is a multiple of ten, and sequences restart at 0.
        let since_the_last_0 = step % 65_536;
        let of = step - since_the_last_0 % EVERY;
        assert_eq!(*telemetry_time_s, time_s[of], "telemetry of step {of}, in force at step {step}");
    }
}

#[test]
fn a_fault_beyond_the_wraparound_is_reported_with_its_step() {
    let records = Records::new();
    let text = fs::read_to_string(workspace().join(SCENARIO)).expect("a scenario");
    let fault = "[[fault]]\nkind = \"encoder-jump\"\nside = \"load\"\ncounts = 2000\nat_s = 66.0\n";
    let scenario = records.path("jump.toml");
    fs::write(&scenario, format!("{text}\n{fault}")).expect("a scenario of the test");
    let scenario = scenario.to_str().expect("a path in UTF-8");
    let ended = run(scenario, &records, &["run.duration_s=70"], 1);
    assert!(
        ended.stdout.contains("the drive latched LoadEncoderJump at sample 66000: the load at "),
        "{}",
        ended.stdout
    );
}

#[test]
fn a_load_settles_through_a_wraparound_of_the_motor_encoder() {
    let records = Records::new();
    // 2^23 counts are two turns of the motor, 12.6 rad; the motor travels 21 rad.
    let settings = ["encoders.motor_counts_per_rev=4194304", "reference.position_rad=7"];
    let _ = run(SCENARIO, &records, &settings, 0);
    let trace = records.trace();
    let (motor_rad, load_rad) = (trace.column("motor_position_rad"), trace.column("load_position_rad"));
    let last = trace.len() - 1;
    assert!(motor_rad[last] > 20.0, "{} rad", motor_rad[last]);
    assert!((load_rad[last] - 7.0).abs() < 2.1e-3, "{} rad", load_rad[last]);
}

#[test]
fn a_start_outside_the_encoder_range_is_rejected() {
    let records = Records::new();
    // The motor starts at three quarters of a turn.
    let ended = run(SCENARIO, &records, &["encoders.motor_counts_per_rev=16777216"], 2);
    assert!(
        ended.stderr.contains("the motor encoder, with its faults, stands at 12582912 counts"),
        "{}{}",
        ended.stdout,
        ended.stderr
    );
}

#[test]
fn a_start_outside_the_encoder_range_by_a_fault_is_rejected() {
    let records = Records::new();
    let text = fs::read_to_string(workspace().join("scenarios/smooth-after.toml")).expect("a scenario");
    let scenario = records.path("jump.toml");
    let fault = "[[fault]]\nkind = \"encoder-jump\"\nside = \"motor\"\ncounts = 1000\nat_s = 0.0\n";
    fs::write(&scenario, format!("{text}\n{fault}")).expect("a scenario of the test");
    let scenario = scenario.to_str().expect("a path in UTF-8");
    // 8,388,000 counts of 131,072 a turn, just below 2^23.
    let settings = ["plant.initial.motor_position_rad=402.09381", "meant=[\"start\", \"large-angle\"]"];
    let ended = run(scenario, &records, &settings, 2);
    assert!(
        ended.stderr.contains("the motor encoder, with its faults, stands at 8388981 counts"),
        "{}{}",
        ended.stdout,
        ended.stderr
    );
}
