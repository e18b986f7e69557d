//! `lashloop run --rig`.

use std::fs;
use std::path::Path;

use rustix::process::Signal;
use tests::loss::run_in_progress;
use tests::paper::{PATIENCE, RUNS};
use tests::program::{self, Ended, Running};
use tests::records::Records;
use tests::twin::Twin;

use crate::bench::RigFile;

fn run(rig: &RigFile, more: &[&str]) -> Ended {
    program::run([&["run", &RUNS[1].scenario(), "--rig", &rig.path()], more].concat())
}

/// A rig whose run would be a connection to a twin that doesn't exist.
const NOWHERE: &str = "/dev/serial/by-id/usb-none";

#[test]
fn a_run_on_a_rig_has_the_torques_of_its_device() {
    let (twin, records) = (Twin::start(), Records::new());
    let out = records.out();
    let ended = run(&RigFile::new(&twin.device()), &[&PATIENCE[..], &["--out", &out]].concat()).with_code(0);
    assert!(ended.stdout.starts_with("PASS  "), "{}", ended.stdout);
    assert_eq!(records.summary()["torque_sha256"], RUNS[1].torque_sha256);
}

#[test]
fn the_torque_limit_of_the_rig_holds_where_the_scenario_has_none() {
    let (twin, records) = (Twin::start(), Records::new());
    let rig = RigFile::with(&twin.device(), "native-twin", "torque_nm = 1.5\nload_travel_rad = 2.0");
    let text = fs::read_to_string(tests::workspace().join(RUNS[1].scenario())).expect("a scenario");
    let scenario = records.path("without-limit.toml");
    fs::write(&scenario, text.replace("torque_limit_nm = 25.0\n", "")).expect("a scenario without a limit");
    let (scenario, out) = (scenario.display().to_string(), records.out());
    let settings = ["--set", "run.duration_s=1", "--set", "expect=[]", "--out", &out];
    let _ = program::run([&["run", &scenario, "--rig", &rig.path()], &PATIENCE[..], &settings].concat())
        .with_code(0);
    let trace = records.trace();
    let peak_nm = trace.column("torque_nm").iter().fold(0.0_f64, |peak, torque| peak.max(torque.abs()));
    assert!((peak_nm - 1.5).abs() < 1e-6, "the law saturates at {peak_nm} N m");
}

#[test]
fn a_parameter_beyond_the_limits_reaches_no_drive() {
    // The port doesn't exist: opening it would be another error.
    let rig = RigFile::with(NOWHERE, "native-twin", "torque_nm = 5.0\nload_travel_rad = 0.5");
    let torque = run(&rig, &["--set", "controller.parameters.torque_limit_nm=6"]).with_code(2).stderr;
    let want = format!("exceeds the rig; {} allows limits.torque_nm = 5 N m", rig.path());
    assert!(torque.contains("torque_limit_nm=6") && torque.contains(&want), "{torque}");
}

/// Only the drive's description tells whether a reference is a position.
#[test]
fn a_reference_beyond_the_travel_moves_no_drive() {
    let twin = Twin::start();
    let rig = RigFile::with(&twin.device(), "native-twin", "torque_nm = 5.0\nload_travel_rad = 0.5");
    let far = [
        "--set",
        "reference.position_rad=0.6",
        "--set",
        "meant=start",
        "--set",
        "controller.parameters.torque_limit_nm=5",
    ];
    let records = Records::new();
    let ended = run(&rig, &[&far[..], &["--out", &records.out()]].concat()).with_code(2);
    assert!(ended.stderr.contains("the reference reaches 0.600000 rad"), "{}", ended.stderr);
    assert_eq!(ended.stdout, "", "a verdict without a run");
    assert!(!Path::new(&records.out()).join("run.mcap").exists(), "a record without a run");
}

#[test]
fn a_record_of_a_rig_is_run_again_on_the_rig_alone() {
    let (twin, records) = (Twin::start(), Records::new());
    let (rig, out) = (RigFile::new(&twin.device()), records.out());
    let short = ["--set", "run.duration_s=0.5", "--set", "expect=[]", "--out", &out];
    let _ = run(&rig, &[&PATIENCE[..], &short].concat()).with_code(0);
    let without = program::run(["rerun", &out]).with_code(2).stderr;
    assert!(without.contains(&format!("give --rig '{}', whose limits a run keeps", rig.path())), "{without}");
    let _ = program::run(["rerun", &out, "--rig", &rig.path()]).with_code(0);
    let beyond = ["rerun", &out, "--rig", &rig.path(), "--set", "controller.parameters.torque_limit_nm=1000"];
    assert!(program::run(beyond).with_code(2).stderr.contains("exceeds the rig"));
}

#[test]
fn a_frequency_response_keeps_within_the_limits_of_the_rig() {
    let twin = Twin::start();
    let rig = RigFile::with(&twin.device(), "native-twin", "torque_nm = 5.0\nload_travel_rad = 2.0");
    let path = rig.path();
    let short =
        ["--mode", "hil", "--lowest-hz", "2", "--lines", "8", "--settles-s", "0.5", "--realisations", "3"];
    let bode = |more: &[&str]| {
        let start = ["bode", "scenarios/shaft-pd.toml", "--rig", &path];
        program::run([&start[..], &short, &PATIENCE, more].concat())
    };
    let without = bode(&[]).with_code(2).stderr;
    assert!(without.contains("exceeds the rig"), "{without}");
    let within = bode(&["--set", "controller.parameters.torque_limit_nm=5"]).with_code(0);
    assert!(within.stdout.contains(" lines coherent"), "{}", within.stdout);
    let torque = within.stdout.lines().find_map(|it| it.strip_prefix("torque of the drive  up to "));
    let torque = torque.and_then(|it| it.strip_suffix(" N m")).expect("the largest torque");
    assert!((0.1..=5.0).contains(&torque.parse::<f64>().expect("a number")), "{}", within.stdout);
}

#[test]
fn absent_hardware_is_no_verdict() {
    let ended = run(&RigFile::new(NOWHERE), &[]).with_code(5);
    assert!(
        ended.stderr.contains("hardware absent: there is no /dev/serial/by-id/usb-none"),
        "{}",
        ended.stderr
    );
    assert!(ended.stderr.contains("ask A. Engineer"), "{}", ended.stderr);
    assert_eq!(ended.stdout, "", "a verdict without a run");
}

#[test]
fn a_second_run_names_the_holder_and_the_first_one_continues() {
    let twin = Twin::start();
    let (rig, records) = (RigFile::new(&twin.device()), Records::new());
    let (path, out) = (rig.path(), records.out());
    let endless = ["--set", "run.duration_s=100000", "--set", "record.flush_rows=10", "--out", &out];
    let first = Running::start([&["run", &RUNS[1].scenario(), "--rig", &path], &endless[..]].concat());
    records.wait_for_rows();
    let message = run(&rig, &[]).with_code(4).stderr;
    let holder = format!("{}: the rig is in use by process {} of ", twin.device(), first.id());
    assert!(
        message.contains(&holder) && message.contains("lashloop run scenarios/smooth-after.toml"),
        "{message}"
    );
    first.signal(Signal::KILL);
    let _ = first.wait();
    // The kernel has released the lock of the killed run.
    let after = run(&rig, &["--set", "run.duration_s=0.1", "--set", "expect=[]"]);
    let _ = after.with_code(0);
}

#[test]
fn a_device_in_use_without_a_rig_is_in_use_for_a_rig_too() {
    let twin = Twin::start();
    let (first, _records) = run_in_progress(&twin.device());
    let message = run(&RigFile::new(&twin.device()), &[]).with_code(4).stderr;
    assert!(message.contains("another program holds it"), "{message}");
    first.signal(Signal::INT);
    let _ = first.wait().with_code(3);
}

#[test]
fn a_drive_on_another_board_is_rejected() {
    let twin = Twin::start();
    let rig = RigFile::with(&twin.device(), "odrive-v3", "torque_nm = 50.0\nload_travel_rad = 2.0");
    let message = run(&rig, &[]).with_code(4).stderr;
    assert!(message.contains("its board is native-twin") && message.contains("is odrive-v3"), "{message}");
}

#[test]
fn a_rig_and_a_device_exclude_each_other() {
    let ended = run(&RigFile::new(NOWHERE), &["--device", "inproc"]).with_code(2);
    assert!(ended.stderr.contains("cannot be used with"), "{}", ended.stderr);
}

#[test]
fn bench_mode_on_a_drive_without_pins_names_the_missing_parameter() {
    let twin = Twin::start();
    let rig = with_scale(&twin.device(), "torque_nm = 50.0\nload_travel_rad = 2.0");
    let bench = |rig: &RigFile, clock: &str| {
        run(rig, &["--mode", "bench", "--clock", clock, "--set", "run.duration_s=1"])
    };
    let refused = bench(&rig, "real-time").with_code(4).stderr;
    assert!(refused.contains("no parameter sample_source, so it has no bench mode"), "{refused}");
    // Another clock gives the twin no pins.
    let lockstep = bench(&rig, "lockstep").with_code(2).stderr;
    assert!(
        lockstep.contains("has no encoders and no power stage") && !lockstep.contains("real-time"),
        "{lockstep}"
    );
    let unscaled = bench(&RigFile::new(&twin.device()), "real-time").with_code(2).stderr;
    assert!(unscaled.contains("power_stage.torque_per_duty_nm is missing"), "{unscaled}");
}

/// A rig that bench mode is allowed on.
fn with_scale(device: &str, limits: &str) -> RigFile {
    RigFile::with(device, "native-twin", &format!("{limits}\n[power_stage]\ntorque_per_duty_nm = 62.5"))
}

#[test]
fn an_experiment_takes_the_limits_of_the_rig_and_moves_no_load_without_a_drive() {
    let (twin, records) = (Twin::start(), Records::new());
    let (rig, out) = (with_scale(&twin.device(), "torque_nm = 2.0\nload_travel_rad = 3.2"), records.out());
    let ended = program::run(["paper", "experiment", "--rig", &rig.path(), "--out", &out]).with_code(4);
    let reduced = "bench-smooth-before.toml: torque_limit_nm is 2 N m by limits.torque_nm, not 25";
    assert!(ended.stderr.contains(reduced), "{}", ended.stderr);
    assert!(ended.stderr.contains("no parameter sample_source"), "{}", ended.stderr);
    assert!(!ended.stdout.contains("bring the load"), "{}", ended.stdout);
    let absent =
        program::run(["paper", "experiment", "--device", "/dev/serial/by-id/usb-none", "--out", &out])
            .with_code(4);
    assert!(!absent.stdout.contains("bring the load"), "{}", absent.stdout);
}

#[test]
fn commissioning_names_the_missing_limit_of_the_rig_and_opens_the_drive_before_it_asks() {
    let twin = Twin::start();
    let commission = |limits: &str, more: &[&str]| {
        let rig = with_scale(&twin.device(), limits);
        program::run([&["commission", "--rig", &rig.path(), "--yes"], more].concat())
    };
    let missing = commission("torque_nm = 2.0\nload_travel_rad = 3.2", &[]).with_code(2).stderr;
    assert!(
        missing.contains("--motor-speed-limit is missing, and ")
            && missing.contains("no limits.motor_speed_rad_s"),
        "{missing}"
    );
    let negative =
        commission("torque_nm = 2.0\nload_travel_rad = 3.2", &["--torque-limit", "-1"]).with_code(2).stderr;
    assert!(negative.contains("-1 is not above 0"), "{negative}");
    let limits = "torque_nm = 2.0\nload_travel_rad = 3.2\nmotor_speed_rad_s = 90.0\nload_speed_rad_s = 10.0";
    let without_pins = commission(limits, &[]).with_code(4).stderr;
    assert!(
        without_pins.contains("no parameter sample_source") && !without_pins.contains("about to move"),
        "{without_pins}"
    );
}

#[test]
fn a_gate_names_a_file_that_has_no_estimates() {
    let records = Records::new();
    let file = records.path("bad.toml");
    fs::write(&file, "title = 3\n").expect("a file");
    let gate = format!("--gate={}", file.display());
    let ended = program::run(["run", &RUNS[1].scenario(), "--device", "inproc", &gate]).with_code(2);
    assert!(ended.stderr.contains("it isn't an estimates.json of `lashloop commission`"), "{}", ended.stderr);
}
