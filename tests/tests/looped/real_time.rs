//! Real time: how the bench handles late samples and answers, and its own sleep. Tests of wall-clock time are in `wall_clock`.

use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

use lashloop_bench::run::End;
use lashloop_bench::timing::StepOutcome;
use lashloop_protocol::{Decoder, HostMessage, Numbered};
use serde_json::Value;
use tests::paper::RUNS;
use tests::program;
use tests::records::Records;
use tests::scripted::{Made, Script};

/// The paper's second run.
const SMOOTH_AFTER: &str = "scenarios/smooth-after.toml";
/// The paper's third run, in which the torque changes from step to step.
const FRICTION_BEFORE: &str = "scenarios/friction-before.toml";

/// Late steps end no run; too short a run meets no expectation.
const TOLERANT: [&str; 4] =
    ["allow.late=1000000", "allow.lost=1000000", "controller.parameters.watchdog_us=5000000", "expect=[]"];

/// Makes a run with these settings and those of [`TOLERANT`].
fn made(script: &Script<'_>) -> Made {
    let settings = [&TOLERANT, script.settings].concat();
    Script { settings: &settings, ..*script }.run()
}

/// The number of steps that came to nothing.
fn late(made: &Made) -> usize {
    made.with(StepOutcome::Missed).len() + made.with(StepOutcome::Unanswered).len()
}

#[test]
fn a_real_time_run_without_late_steps_equals_lockstep() {
    let script = Script { scenario: SMOOTH_AFTER, ..Script::default() };
    let in_real_time = script.run();
    assert_eq!((late(&in_real_time), in_real_time.steps.len()), (0, 25_000));
    let outcome = in_real_time.outcome();
    assert_eq!((&*outcome.torque_sha256, &outcome.end), (RUNS[1].torque_sha256, &End::Complete));
    // The last step begins a period before the end, and its answer comes at once.
    assert_eq!(outcome.wall_s, 24.999);
    let in_lockstep = Script { in_lockstep: true, ..script }.run();
    assert!(in_lockstep.steps.iter().zip(&in_real_time.steps).all(|(one, other)| one.row == other.row));
}

#[test]
fn a_late_answer_holds_the_torque_and_keeps_the_step_grid() {
    let made = made(&Script {
        scenario: FRICTION_BEFORE,
        faults: "[[fault]]\nkind = \"link-stall\"\nway = \"to-bench\"\nat_s = 0.7\nfor_s = 0.02\n",
        settings: &["run.duration_s=2"],
        ..Script::default()
    });
    let outcome = made.outcome();
    let torque_nm = made.torque_nm();
    assert_eq!(made.with(StepOutcome::Unanswered), (700..720).collect::<Vec<_>>());
    assert!(torque_nm[699..720].windows(2).all(|two| two[0] == two[1]), "the torque is held");
    assert!(torque_nm[699] != torque_nm[698] && torque_nm[720] != torque_nm[719], "and is not constant");
    // An answer that comes late is counted, and used for nothing.
    assert_eq!((outcome.timing.longest_run_of_late, outcome.link.late, outcome.link.lost), (20, 20, 0));
    assert_eq!(outcome.wall_s, 1.999, "the lost time makes the run no longer");
}

#[test]
fn a_held_torque_ends_with_the_watchdog_time_of_the_drive() {
    let made = made(&Script {
        scenario: FRICTION_BEFORE,
        faults: "[[fault]]\nkind = \"link-byte-loss\"\nshare = 1.0\nway = \"to-bench\"\nat_s = 0.7\nfor_s = 0.9\n",
        settings: &[
            "run.duration_s=2",
            "controller.parameters.watchdog_us=600000",
            "allow.crc_errors=1000000",
        ],
        ..Script::default()
    });
    assert_eq!(made.outcome().end, End::Complete);
    assert_eq!(made.with(StepOutcome::Unanswered), (700..1_600).collect::<Vec<_>>());
    let torque_nm = made.torque_nm();
    assert!(torque_nm[699] != 0.0, "a torque to be held");
    assert!(torque_nm[699..1_299].iter().all(|torque| *torque == torque_nm[699]), "held too briefly");
    assert!(torque_nm[1_299..1_600].iter().all(|torque| *torque == 0.0), "held for too long");
    assert!(torque_nm[1_600] != 0.0, "the drive gives torque again");
}

#[test]
fn a_bench_asleep_through_steps_skips_them_without_a_burst() {
    let made = made(&Script {
        scenario: SMOOTH_AFTER,
        settings: &["run.duration_s=4"],
        sleeps: &[[1.0005, 1.2005]],
        ..Script::default()
    });
    let outcome = made.outcome();
    assert_eq!(made.with(StepOutcome::Missed), (1_001..1_200).collect::<Vec<_>>());
    assert_eq!((made.steps.len(), outcome.timing.missed), (4_000, 199), "a missed step has its row as well");
    let lateness_us = made.steps[1_200].timing.lateness.as_micros();
    assert_eq!(lateness_us, 500, "the step in which the bench awakes");
    // No burst: missed samples are never sent. The other frames are Arm, Start and Stop.
    assert_eq!(outcome.link.frames_sent, 4_000 - 199 + 3);
    assert_eq!(outcome.wall_s, 3.999);
}

#[test]
fn a_bench_asleep_past_the_longest_gap_ends_or_resumes() {
    // The torque of the step at which the bench falls asleep is held for 1.5 s, and the way back is as long. With the
    // default limit the motor exceeds the plausible speed on either.
    let settings = ["run.duration_s=4", "allow.resumes=1", "controller.parameters.torque_limit_nm=2"];
    let asleep = |on_loss| {
        let settings = [&settings[..], &[on_loss]].concat();
        let sleeps = &[[1.0005, 2.5005]];
        made(&Script { scenario: SMOOTH_AFTER, settings: &settings, sleeps, ..Script::default() })
    };
    let error = asleep("link.on_loss=end").outcome.expect_err("no sample fits").to_string();
    assert!(error.contains("control periods and takes no sample after that"), "{error}");

    let resumed = asleep("link.on_loss=resume");
    let outcome = resumed.outcome();
    assert_eq!((&outcome.end, outcome.link.resumes), (&End::Complete, 1));
    let answered = resumed.with(StepOutcome::Answered);
    assert_eq!(answered.iter().filter(|step| **step >= 3_500).count(), 500, "the drive is back");
}

#[test]
fn the_watchdog_of_the_drive_trips_while_the_bench_sleeps() {
    // The second pause exceeds the longest gap; the fault report is on the line before.
    for until_s in [1.6005, 2.5005] {
        let made = made(&Script {
            scenario: SMOOTH_AFTER,
            settings: &["run.duration_s=10", "controller.parameters.watchdog_us=200000"],
            sleeps: &[[1.0005, until_s]],
            ..Script::default()
        });
        let end = made.outcome().end.to_string();
        assert!(end.starts_with("the drive latched Watchdog at sample 1000: no sample for "), "{end}");
    }
}

#[test]
fn a_slow_restart_is_repeated_at_the_present_step() {
    static STARTS: AtomicU32 = AtomicU32::new(0);
    // The second start follows the reset; the bench detects its loss after half a second.
    let loses = |bytes: &[u8]| {
        let message = Decoder::new().next::<HostMessage>(&mut &*bytes).and_then(Result::ok);
        matches!(message, Some(Numbered { message: HostMessage::Start(_), .. }))
            && STARTS.fetch_add(1, Ordering::Relaxed) == 1
    };
    let made = made(&Script {
        scenario: SMOOTH_AFTER,
        faults: "[[fault]]\nkind = \"device-reset\"\nat_s = 0.5\n",
        settings: &["run.duration_s=3", "link.on_loss=resume", "allow.resumes=1"],
        loses: Some(loses),
        ..Script::default()
    });
    assert!(STARTS.load(Ordering::Relaxed) > 2, "the start is repeated");
    let outcome = made.outcome();
    assert_eq!((&outcome.end, outcome.link.resumes), (&End::Complete, 1));
    let answered = made.with(StepOutcome::Answered);
    assert!(!answered.iter().any(|step| (500..1_000).contains(step)), "half a second without a drive");
    assert_eq!(answered.iter().filter(|step| **step >= 1_100).count(), 1_900, "and it is back");
}

#[test]
fn a_denied_privilege_is_reported_and_the_run_continues() {
    let records = Records::new();
    let out = records.out();
    let arguments = ["run", SMOOTH_AFTER, "--device", "native", "--out", &out, "--clock", "real-time"];
    // On a busy machine samples are late, and the loop swings.
    let calm = ["run.duration_s=0.2", "controller.parameters.motor_speed_limit_rad_s=10000"];
    let settings = TOLERANT.iter().chain(&calm).flat_map(|setting| ["--set", setting]);
    // Without its capabilities root is refused as anyone.
    let is_root = rustix::process::geteuid().is_root();
    let mut command = Command::new(if is_root { Path::new("setpriv") } else { program::lashloop() });
    if is_root {
        command.arg("--bounding-set=-all").arg(program::lashloop());
    }
    command.args(arguments.into_iter().chain(settings).chain(["--fifo", "50"]));
    let ended = program::Running::start_command(command).wait();
    assert!(ended.stdout.contains("not granted: SCHED_FIFO priority 50: "), "{}", ended.stdout);
    assert_eq!(records.summary()["end"], Value::from("complete"));
}

#[test]
fn real_time_options_are_rejected_in_lockstep() {
    for option in [&["--spin-us", "10"][..], &["--fifo", "5"], &["--lock-memory"], &["--core", "0"]] {
        let arguments = ["run", "scenarios/smooth-after.toml", "--device", "inproc"];
        let ended = program::run(arguments.iter().chain(option)).with_code(2);
        assert!(ended.stderr.contains(&format!("{} needs --clock real-time", option[0])), "{}", ended.stderr);
    }
}
