//! The loop paced by wall-clock time. No test here bounds a lateness, because the machine may be busy: the tests check how
//! the bench handles a late step.

use std::thread;
use std::time::Duration;

use lashloop_protocol::HostMessage;
use rustix::process::Signal;
use serde_json::Value;
use tests::paper::RUNS;
use tests::program::{self, Running};
use tests::records::Records;
use tests::relay::{Action, Relay};
use tests::twin::Twin;

/// A busy machine causes late steps; these limits keep them out of the verdict.
const TOLERANT: [&str; 6] = [
    "--set",
    "allow.late=1000000",
    "--set",
    "controller.parameters.watchdog_us=5000000",
    "--set",
    "record.flush_rows=10",
];

fn arguments<'a>(scenario: &'a str, device: &'a str, out: &'a str, duration: &'a str) -> Vec<&'a str> {
    let mut arguments = vec!["run", scenario, "--device", device, "--out", out, "--set", duration];
    arguments.extend(["--clock", "real-time"]);
    arguments.extend(TOLERANT);
    // The run is too short for the expectation of the scenario.
    arguments.extend(["--set", "expect.0.max=1000", "--set", "expect.0.min=0"]);
    arguments
}

fn count(summary: &Value, section: &str, name: &str) -> u64 {
    summary[section][name].as_u64().unwrap_or_else(|| panic!("{section}.{name} in {summary}"))
}

/// Number of ones in a column of flags.
fn ones(records: &Records, column: &str) -> u64 {
    records.timing().column(column).iter().filter(|flag| **flag == 1.0).count() as u64
}

#[test]
fn a_real_time_run_takes_the_time_it_simulates() {
    let records = Records::new();
    let ended = program::run(arguments(&RUNS[1].scenario(), "native", &records.out(), "run.duration_s=2"));
    assert!(ended.code.is_some_and(|code| code < 4), "{}", ended.stderr);
    let summary = records.summary();
    assert_eq!((&summary["timing"]["clock"], &summary["end"]), (&"real-time".into(), &"complete".into()));
    let wall_s = summary["wall_s"].as_f64().expect("a time");
    // The last step ends with its torque, up to a period before the end of the run.
    assert!(wall_s > 1.998, "2 s of the plant in {wall_s} s");
    assert_eq!((records.trace().len(), records.timing().len()), (2_000, 2_000));
    assert_eq!(ones(&records, "missed"), count(&summary, "timing", "missed"));
    let answered = 2_000 - count(&summary, "timing", "missed") - count(&summary, "timing", "unanswered");
    assert_eq!(ones(&records, "answered"), answered);
}

#[test]
fn a_real_time_run_without_late_steps_equals_lockstep() {
    let duration = "run.duration_s=0.3";
    let digest = |real_time: bool| {
        let records = Records::new();
        let (scenario, out) = (RUNS[1].scenario(), records.out());
        let mut arguments = arguments(&scenario, "native", &out, duration);
        if !real_time {
            arguments.retain(|argument| !["--clock", "real-time"].contains(argument));
        }
        let _ = program::run(arguments);
        let summary = records.summary();
        let late = count(&summary, "timing", "missed") + count(&summary, "timing", "unanswered");
        (late == 0).then(|| summary["torque_sha256"].clone())
    };
    let in_real_time = (0..50).find_map(|_| digest(true));
    assert!(in_real_time.is_some(), "no run of 300 steps without a late one among 50");
    assert_eq!(in_real_time, digest(false));
}

#[test]
fn a_late_answer_holds_the_torque_and_keeps_the_step_grid() {
    const HIT: u16 = 700;
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| {
        if frame.torque().is_some_and(|torque| torque.sequence == HIT) {
            thread::sleep(Duration::from_millis(20));
        }
        Action::Forward
    });
    let records = Records::new();
    let ended =
        program::run(arguments(&RUNS[2].scenario(), relay.device(), &records.out(), "run.duration_s=2"));
    assert!(ended.code.is_some_and(|code| code < 4), "{}", ended.stderr);
    let (summary, trace, timing) = (records.summary(), records.trace(), records.timing());
    let (torque_nm, answered) = (trace.column("torque_nm"), timing.column("answered"));
    let at = usize::from(HIT);
    assert_eq!(answered[at], 0.0, "{}", ended.stdout);
    assert_eq!(torque_nm[at], torque_nm[at - 1], "the torque of a late step is the one before");
    assert!(torque_nm[at - 1] != torque_nm[at - 2], "different neighbours show that the torque is held");
    // The answer is twenty periods late, so about twenty steps have no answer in time and late answers.
    assert!(count(&summary, "timing", "longest_run_of_late") >= 15, "{}", ended.stdout);
    assert!(count(&summary, "link", "late") >= 15, "{}", ended.stdout);
    let after = answered[at + 100..].iter().sum::<f64>() / (answered.len() - at - 100) as f64;
    assert!(after > 0.5, "{after} of the steps after it are answered");
    let wall_s = summary["wall_s"].as_f64().expect("a time");
    assert!(wall_s < 2.5, "a run of 2 s must not be longer by the lost time, and took {wall_s} s");
}

#[test]
fn a_held_torque_ends_with_the_watchdog_time_of_the_drive() {
    const SILENT: std::ops::RangeInclusive<u16> = 700..=1_600;
    const WATCHDOG_STEPS: usize = 600;
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), |frame| {
        let is_silenced = frame.torque().is_some_and(|torque| SILENT.contains(&torque.sequence));
        if is_silenced { Action::Replace(Vec::new()) } else { Action::Forward }
    });
    let records = Records::new();
    let (scenario, out) = (RUNS[2].scenario(), records.out());
    let mut arguments = arguments(&scenario, relay.device(), &out, "run.duration_s=2");
    arguments.extend(["--set", "controller.parameters.watchdog_us=600000", "--set", "allow.lost=1000"]);
    let ended = program::run(arguments);
    assert_eq!(records.summary()["end"], "complete", "{}{}", ended.stdout, ended.stderr);
    let (torque_nm, answered) = (records.trace().column("torque_nm"), records.timing().column("answered"));
    let last = answered[..700].iter().rposition(|flag| *flag == 1.0).expect("an answer before the silence");
    let removed = last + WATCHDOG_STEPS;
    assert!(torque_nm[last] != 0.0, "a torque to be held");
    assert!(torque_nm[last..removed].iter().all(|torque| *torque == torque_nm[last]), "held too briefly");
    assert!(torque_nm[removed..=1_600].iter().all(|torque| *torque == 0.0), "held for too long");
    let next = 1_601 + answered[1_601..].iter().position(|flag| *flag == 1.0).expect("an answer after it");
    assert!(torque_nm[next] != 0.0, "the drive gives torque again");
}

/// Suspends a bench during its run.
fn suspend(bench: &Running, records: &Records, time: Duration) {
    records.wait_for_rows();
    bench.signal(Signal::STOP);
    thread::sleep(time);
    bench.signal(Signal::CONT);
}

#[test]
fn a_bench_asleep_through_steps_skips_them_without_a_burst() {
    let records = Records::new();
    let bench = Running::start(arguments(&RUNS[1].scenario(), "native", &records.out(), "run.duration_s=4"));
    suspend(&bench, &records, Duration::from_millis(200));
    let ended = bench.wait();
    let (summary, timing) = (records.summary(), records.timing());
    let missed = count(&summary, "timing", "missed");
    assert!(missed >= 150, "{}", ended.stdout);
    assert_eq!(records.trace().len(), 4_000, "every step has its row, missed ones as well");
    // No burst: missed samples are never sent. The other frames are Arm, Start and Stop.
    let sent = count(&summary, "link", "frames_sent");
    assert!(sent <= 4_000 - missed + 3, "{sent} frames");
    assert!(timing.column("missed").iter().sum::<f64>() >= 150.0);
    let wall_s = summary["wall_s"].as_f64().expect("a time");
    assert!(wall_s < 4.5, "4 s of the plant in {wall_s} s");
}

#[test]
fn a_bench_asleep_past_the_longest_gap_ends_or_resumes() {
    for (on_loss, code) in [("end", 4), ("resume", 1)] {
        let records = Records::new();
        let (scenario, out) = (RUNS[1].scenario(), records.out());
        let mut arguments = arguments(&scenario, "native", &out, "run.duration_s=4");
        let on_loss = format!("link.on_loss={on_loss}");
        arguments.extend(["--set", &on_loss, "--set", "allow.resumes=1", "--set", "allow.lost=1"]);
        // The torque of the step at which the bench falls asleep is held for 1.5 s, and the way back is as long. With the
        // default limit the motor exceeds the plausible speed on either.
        arguments.extend(["--set", "controller.parameters.torque_limit_nm=2"]);
        let bench = Running::start(arguments);
        suspend(&bench, &records, Duration::from_millis(1_500));
        let ended = bench.wait();
        if code == 4 {
            let reason = "control periods and takes no sample after that";
            assert!(ended.with_code(4).stderr.contains(reason));
        } else {
            let summary = records.summary();
            assert_eq!((&summary["end"], &summary["link"]["resumes"]), (&"complete".into(), &1.into()));
            let answered = records.timing().column("answered");
            let last = answered[answered.len() - 500..].iter().sum::<f64>();
            assert!(last > 250.0, "{last} of the last 500 steps are answered");
        }
    }
}

#[test]
fn the_watchdog_of_the_drive_trips_while_the_bench_sleeps() {
    // The second pause exceeds the longest gap; the fault report is on the line before.
    for pause_ms in [600, 1_500] {
        let records = Records::new();
        let (scenario, out) = (RUNS[1].scenario(), records.out());
        let mut arguments = arguments(&scenario, "native", &out, "run.duration_s=10");
        for argument in &mut arguments {
            if argument.ends_with("watchdog_us=5000000") {
                *argument = "controller.parameters.watchdog_us=200000";
            }
        }
        let bench = Running::start(arguments);
        suspend(&bench, &records, Duration::from_millis(pause_ms));
        let ended = bench.wait().with_code(3);
        assert!(ended.stdout.contains("ENDED  the drive latched Watchdog at sample "), "{}", ended.stdout);
    }
}

#[test]
fn a_slow_restart_is_repeated_at_the_present_step() {
    let twin = Twin::start();
    let mut starts = 0;
    // The second start follows the loss; the bench detects its loss after half a second.
    let relay = Relay::start(twin.path(), move |frame| {
        starts += usize::from(matches!(frame.from_bench(), Some(HostMessage::Start(_))));
        let is_lost = starts == 2 && matches!(frame.from_bench(), Some(HostMessage::Start(_)));
        if is_lost { Action::Replace(Vec::new()) } else { Action::Forward }
    });
    let records = Records::new();
    let text = std::fs::read_to_string(tests::workspace().join(RUNS[1].scenario())).expect("a scenario");
    let scenario = records.path("reset.toml");
    let fault = "[[fault]]\nkind = \"device-reset\"\nat_s = 0.5\n";
    std::fs::write(&scenario, format!("{text}\n{fault}")).expect("a scenario of the test");
    let (scenario, out) = (scenario.display().to_string(), records.out());
    let mut arguments = arguments(&scenario, relay.device(), &out, "run.duration_s=3");
    arguments.extend(["--set", "link.on_loss=resume", "--set", "allow.resumes=1", "--set", "allow.lost=1"]);
    let ended = program::run(arguments);
    let summary = records.summary();
    assert_eq!(
        (&summary["end"], &summary["link"]["resumes"]),
        (&"complete".into(), &1.into()),
        "{}",
        ended.stdout
    );
    let answered = records.timing().column("answered");
    let last = answered[answered.len() - 500..].iter().sum::<f64>();
    assert!(last > 250.0, "{last} of the last 500 steps are answered");
}

#[test]
fn a_denied_privilege_is_reported_and_the_run_continues() {
    let records = Records::new();
    let (scenario, out) = (RUNS[1].scenario(), records.out());
    let mut arguments = arguments(&scenario, "native", &out, "run.duration_s=0.2");
    arguments.extend(["--core", "999999"]);
    let ended = program::run(arguments);
    assert!(ended.stdout.contains("not granted: core 999999: "), "{}", ended.stdout);
    assert_eq!(records.summary()["end"], "complete");
}

#[test]
fn real_time_options_are_rejected_in_lockstep() {
    for option in [&["--spin-us", "10"][..], &["--fifo", "5"], &["--lock-memory"], &["--core", "0"]] {
        let arguments = ["run", "scenarios/smooth-after.toml", "--device", "inproc"];
        let ended = program::run(arguments.iter().chain(option)).with_code(2);
        assert!(ended.stderr.contains(&format!("{} needs --clock real-time", option[0])), "{}", ended.stderr);
    }
}
