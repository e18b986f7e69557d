//! `lashloop budget`: its text and exit code. `wire` compares it with runs on a modelled UART.

use std::thread;
use std::time::{Duration, Instant};

use tests::program;
use tests::relay::{Action, Relay};
use tests::twin::Twin;
use tests::wait::{self, SOON};

const MERZOUKI: &str = "scenarios/shaft-merzouki.toml";

#[test]
fn the_budget_says_where_the_time_goes_and_what_to_change() {
    let ended =
        program::run(["budget", "scenarios/smooth-after.toml", "--baud", "460800", "--period-us", "900"])
            .with_code(1);
    assert_eq!(ended.stderr, "");
    insta::assert_snapshot!(ended.stdout);
}

#[test]
fn exit_code_is_1_if_the_worst_cycle_exceeds_the_period() {
    // 35 bytes at 460,800 Bd take 0.76 of 0.86 ms, and telemetry of 5 signals delays the torque by 0.08 ms, of 6 by 0.16 ms.
    for (options, code) in [
        (&["budget"][..], 0),
        (&["budget", "--baud", "460800", "--period-us", "900", "--signals", "6"], 1),
        (&["budget", "--baud", "460800", "--period-us", "900", "--signals", "5"], 0),
        (&["budget", "--baud", "460800", "--period-us", "900", "--telemetry-every", "0"], 0),
        (&["budget", "--baud", "460800", "--signals", "6"], 0),
        // The first law has more signals than fit behind a torque at this speed.
        (&["budget", "--baud", "460800"], 1),
        (&["budget", "scenarios/shaft-pd.toml", "--baud", "115200"], 1),
        (&["budget", "scenarios/shaft-pd.toml", "--baud", "115200", "--period-us", "8000"], 0),
        (&["budget", "--baud", "100"], 2),
        (&["budget", "scenarios/none.toml"], 2),
    ] {
        let _ = program::run(options).with_code(code);
    }
}

/// A twin behind an adapter whose latency timer of this period passes the drive's torques on.
fn behind_latency_timer(twin: &Twin, timer: Duration) -> Relay {
    let plugged = Instant::now();
    Relay::start(twin.path(), move |frame| {
        if frame.torque().is_some() {
            let elapsed_ns = plugged.elapsed().as_nanos() as u64;
            let timer_ns = timer.as_nanos() as u64;
            thread::sleep(Duration::from_nanos(timer_ns - elapsed_ns % timer_ns));
        }
        Action::Forward
    })
}

/// The side of a law in what `budget --measured` prints, which has its name at the start of a line.
fn side<'a>(text: &'a str, law: &str) -> &'a str {
    let line =
        text.lines().find(|line| line.starts_with(law)).unwrap_or_else(|| panic!("no {law} in\n{text}"));
    line[law.len()..].split_whitespace().next().unwrap_or_default()
}

#[test]
fn latency_timer_of_16_ms_is_outside_and_of_1_ms_inside() {
    let twin = Twin::start();
    let slow = behind_latency_timer(&twin, Duration::from_millis(16));
    let measured = ["--measured", slow.device(), "--rounds", "40"];
    let ended = program::run([&["budget", MERZOUKI][..], &measured].concat()).with_code(1);
    // A busy machine adds jitter, which may be beyond the map too.
    if !ended.stdout.contains("the line is beyond the map") {
        assert_eq!(side(&ended.stdout, "merzouki"), "OUTSIDE", "{}", ended.stdout);
    }
    for sentence in ["p99 exceeds it: the torque is late", "remedy         shorten the round trip"] {
        assert!(ended.stdout.contains(sentence), "{sentence} in\n{}", ended.stdout);
    }
    drop(slow);

    let fast = behind_latency_timer(&twin, Duration::from_millis(1));
    let measured = ["budget", MERZOUKI, "--measured", fast.device(), "--rounds", "100"];
    // Inside up to 5 ms of delay or 4 ms of jitter, which a busy machine exceeds at times.
    let inside = || Some(program::run(measured)).filter(|ended| ended.code == Some(0));
    let ended = wait::look(SOON, inside).expect("inside in one of the measurements");
    assert_eq!(side(&ended.stdout, "merzouki"), "inside", "{}", ended.stdout);
    assert!(!ended.stdout.contains("remedy"), "{}", ended.stdout);
}

#[test]
fn port_without_a_drive_and_scenario_without_a_map_are_errors() {
    for (options, code, words) in [
        (&["budget", "--measured", "/dev/no-such-terminal"][..], 4, "/dev/no-such-terminal"),
        (&["budget", "scenarios/shaft-pd.toml", "--measured", "inproc"], 2, "has no law pd"),
        (&["budget", "--measured", "inproc", "--map", "scenarios"], 2, "scenarios/campaign.json"),
        (&["budget", "--rounds", "100"], 2, "--measured"),
    ] {
        let ended = program::run(options).with_code(code);
        assert!(ended.stderr.contains(words), "{options:?}: {}", ended.stderr);
    }
}

#[test]
fn drive_in_this_process_is_inside_for_every_law() {
    let ended = program::run(["budget", "--measured", "inproc"]).with_code(0);
    assert_eq!(["merzouki", "braking-curve"].map(|law| side(&ended.stdout, law)), ["inside"; 2]);
    assert!(ended.stdout.contains("deadline 950 us of a period of 1000 us"), "{}", ended.stdout);
}
