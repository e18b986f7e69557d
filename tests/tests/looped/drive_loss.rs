//! Loss of the drive during a run: its process ends, hangs, or the line is disconnected.

use std::time::Instant;

use rustix::process::Signal;
use tests::loss::{assert_reported, assert_waited_for, run_in_progress, scenario_in_progress};
use tests::relay::{Action, Relay};
use tests::twin::Twin;
use tests::{c_drive, processes};

#[test]
fn a_killed_twin_on_a_terminal_closes_the_line() {
    let twin = Twin::start();
    let (bench, records) = run_in_progress(&twin.device());
    let lost_at = Instant::now();
    twin.signal(Signal::KILL);
    let sentence = assert_reported(bench, &records, lost_at);
    assert!(
        sentence.contains(&format!("drive on {}: the far end closed the line", twin.device())),
        "{sentence}"
    );
}

#[test]
fn a_killed_own_twin_is_reported_with_process_and_signal() {
    let (bench, records) = run_in_progress("native");
    let [twin] = processes::children(bench.id())[..] else { panic!("the bench has one child") };
    let lost_at = Instant::now();
    processes::signal(twin, Signal::KILL);
    let sentence = assert_reported(bench, &records, lost_at);
    let names = [format!("native twin (process {twin})"), "signal: 9".to_owned()];
    assert!(names.iter().all(|name| sentence.contains(name)), "{sentence}");
}

#[test]
fn a_hung_twin_on_a_terminal_is_reported_as_silent() {
    let twin = Twin::start();
    let (bench, records) = run_in_progress(&twin.device());
    let lost_at = Instant::now();
    twin.signal(Signal::STOP);
    let sentence = assert_reported(bench, &records, lost_at);
    assert!(sentence.contains("the drive was silent for 2.5 s after EncoderSample"), "{sentence}");
}

#[test]
fn a_hung_drive_of_the_bench_is_reported_as_silent_and_killed() {
    // Its output ends some hundred steps after the start, and every process of it sleeps.
    let hangs = "dd bs=1 count=20000 status=none; sleep 1000";
    let device = format!("exec:sh -c '{} | {{ {hangs}; }}'", c_drive::path().display());
    let (bench, records) = scenario_in_progress("examples/drive-in-c/scenario.toml", &device);
    let [drive] = processes::children(bench.id())[..] else { panic!("the bench has one child") };
    let lost_at = Instant::now();
    let sentence = assert_reported(bench, &records, lost_at);
    // Its output may end within a frame, which isn't silence.
    let words = ["no answer to EncoderSample within 2.5 s", "silent for 2.5 s after EncoderSample"];
    assert!(words.iter().any(|words| sentence.contains(words)), "{sentence}");
    assert!(!processes::runs(drive), "the hanging drive was left behind");
}

#[test]
fn a_stopped_twin_of_the_bench_is_waited_for() {
    assert_waited_for("scenarios/faults.toml", "native", 24);
}

#[test]
fn a_disconnect_is_reported_and_the_drive_stays_usable() {
    const LAST: u16 = 3_000;
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| match frame.torque() {
        Some(torque) if torque.sequence == LAST => Action::Disconnect,
        _ => Action::Forward,
    });
    let (bench, records) = run_in_progress(relay.device());
    let lost_at = relay.disconnected_at();
    let sentence = assert_reported(bench, &records, lost_at);
    let progress = "last sample sent: 3000, last good frame received: Telemetry, last torque for sample 2999";
    let or_torque = progress.replace("Telemetry", "TorqueAnswer");
    assert!(sentence.contains(progress) || sentence.contains(&or_torque), "{sentence}");
    assert_eq!(records.trace().len(), usize::from(LAST));
    drop(relay);
    let _ = tests::paper::RUNS[1].pass_on(&twin.device());
}

#[test]
fn a_killed_bench_leaves_no_twin_behind() {
    let (bench, _records) = run_in_progress("native");
    let [twin] = processes::children(bench.id())[..] else { panic!("the bench has one child") };
    bench.signal(Signal::KILL);
    tests::wait::until("the end of the twin", || (!processes::runs(twin)).then_some(()));
    assert_eq!(bench.wait().code, None);
}
