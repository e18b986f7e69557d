//! Tests of wall-clock time, each next to [witnesses](tests::witness). Everything else about time runs on a scripted clock, see
//! `real_time`.

use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;
use tests::fault_table;
use tests::paper::{PATIENCE, RUNS};
use tests::program;
use tests::records::Records;
use tests::relay::{Action, Relay};
use tests::twin::Twin;
use tests::wait::{self, SOON};
use tests::witness::judge;

const MERZOUKI: &str = "scenarios/shaft-merzouki.toml";

#[test]
fn a_real_time_run_takes_the_time_it_simulates_and_equals_lockstep() {
    const STEPS: u64 = 300;
    let run = |clock: &str| {
        let records = Records::new();
        let (scenario, out) = (RUNS[1].scenario(), records.out());
        let arguments = ["run", &scenario, "--device", "native", "--out", &out, "--clock", clock];
        let _ =
            program::run(arguments.into_iter().chain(["--set", "run.duration_s=0.3", "--set", "expect=[]"]));
        let (summary, timing) = (records.summary(), records.timing());
        let made = timing.len() as u64;
        assert_eq!(records.trace().len() as u64, made);
        if made < STEPS {
            // The drive stood still for longer than its watchdog.
            let end = summary["end"].to_string();
            assert!(clock == "real-time" && end.contains("Watchdog"), "{made} steps with {clock}: {end}");
            return (STEPS - made, summary);
        }
        let ones = |column: &str| timing.column(column).iter().filter(|flag| **flag == 1.0).count() as u64;
        let count = |name: &str| summary["timing"][name].as_u64().expect("a count");
        let late = count("missed") + count("unanswered");
        assert_eq!((ones("missed"), ones("answered")), (count("missed"), STEPS - late));
        (late, summary)
    };
    judge(|| {
        let mut in_real_time = (0..50).map(|_| run("real-time")).filter(|(late, _)| *late == 0);
        let (_, summary) = in_real_time.next().expect("a run of 300 steps without a late one among 50");
        assert_eq!((&summary["timing"]["clock"], &summary["end"]), (&"real-time".into(), &"complete".into()));
        // The last step ends with its torque, up to a period before the end of the run.
        let wall_s = summary["wall_s"].as_f64().expect("a time");
        assert!(wall_s > 0.298 && wall_s < 0.31, "0.3 s of the plant in {wall_s} s");
        assert_eq!(summary["torque_sha256"], run("lockstep").1["torque_sha256"]);
    });
}

#[test]
fn the_watchdog_of_the_native_twin_removes_the_torque_in_time() {
    // It looks about every millisecond.
    judge(|| fault_table::check_watchdog_on("native", 0.2));
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
    judge(|| {
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
    });
}

#[test]
fn drive_in_this_process_is_inside_for_every_law() {
    judge(|| {
        let ended = program::run(["budget", "--measured", "inproc"]).with_code(0);
        assert_eq!(["merzouki", "braking-curve"].map(|law| side(&ended.stdout, law)), ["inside"; 2]);
        assert!(ended.stdout.contains("deadline 950 us of a period of 1000 us"), "{}", ended.stdout);
    });
}

const ALWAYS: [&str; 6] = [
    "lockstep: round trips, 1/s",
    "1 kHz: round trip p50, us",
    WATCHED[0],
    WATCHED[1],
    "1 kHz, recording: lateness p50, us",
    "1 kHz, live page: lateness p50, us",
];
const WATCHED: [&str; 2] = ["1 kHz, recording: round trip p50, us", "1 kHz, live page: round trip p50, us"];
/// A loop that waited for the disk or for the stuck reader would take milliseconds instead of 0.1 ms. On a shared machine
/// medians of one round differ by a factor of 2.
const MOST_SLOWED: f64 = 10.0;

fn every_measurement_is_made_and_judged(options: &[&str], judged: &[&str]) {
    let arguments = ["benchmark", "--rounds", "1", "--steps", "200", "--seconds", "1"];
    let ended = program::run(arguments.iter().chain(options));
    let lines: Vec<&str> = ended.stdout.lines().skip(1).collect();
    for what in ALWAYS.iter().chain(judged) {
        let line = lines.iter().find_map(|line| line.strip_prefix(what)).expect(what);
        let figures: Vec<f64> =
            line.split_whitespace().take(3).map(|figure| figure.parse().expect("a number")).collect();
        assert!(figures.iter().all(|figure| figure.is_finite() && *figure >= 0.0), "{what}: {line}");
        assert!(line.ends_with(": met") || line.ends_with(": MISSED"), "{what}: {line}");
        assert!(!WATCHED.contains(what) || figures[2] < MOST_SLOWED, "{what}: {line}");
    }
    let missed = lines.iter().any(|line| line.ends_with(": MISSED"));
    assert_eq!(ended.code, Some(i32::from(missed)), "{}{}", ended.stdout, ended.stderr);
}

#[test]
fn sleeping_loop_is_compared_with_a_sleeping_thread_and_a_busy_waiting_one_with_a_goal() {
    judge(|| {
        every_measurement_is_made_and_judged(&[], &["1 kHz: lateness p50, us", "1 kHz: lateness p99, us"]);
        every_measurement_is_made_and_judged(&["--spin-us", "50"], &["1 kHz, spinning: lateness p99, us"]);
    });
}

/// The best of three runs, because other load only adds time.
fn best_wall_s(device: &str) -> f64 {
    let wall_s = || {
        let records = Records::new();
        let arguments = ["run", &RUNS[1].scenario(), "--device", device, "--out", &records.out()];
        let _ = program::run(arguments.into_iter().chain(PATIENCE)).with_code(0);
        records.summary().get("wall_s").and_then(Value::as_f64).expect("the wall-clock time")
    };
    (0..3).map(|_| wall_s()).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_loop_is_far_faster_than_plant_time() {
    // The bounds are ten times the goals, so that only a regression of the loop exceeds them.
    judge(|| {
        for (device, goal_s) in [("inproc", 0.1), ("native", 2.5)] {
            let (best_s, cap_s) = (best_wall_s(device), 10.0 * goal_s);
            assert!(best_s <= cap_s, "{device}: 25 s of the plant took {best_s} s, at most {cap_s} s");
        }
    });
}
