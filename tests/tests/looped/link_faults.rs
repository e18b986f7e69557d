//! A faulty line: frames lost, damaged or duplicated, and noise between frames. Each run is a whole `friction-before`, so
//! that its verdict is meaningful.

use serde_json::Value;
use tests::paper::RUNS;
use tests::program;
use tests::records::{Records, Trace};
use tests::relay::{Action, Relay, Transit};
use tests::twin::Twin;

/// Sequence of the faulty frame.
const HIT: u16 = 700;

/// A lost answer costs this time. The timeout is long enough for a twin on a busy machine, so that only the chosen frames
/// are lost or late.
const TIMEOUT: [&str; 4] = ["--set", "link.answer_timeout_ms=3000", "--set", "link.silence_limit_ms=20000"];

/// Runs `friction-before` through a relay and expects an exit code.
fn run_through(
    tamper: impl FnMut(&Transit) -> Action + Send + 'static,
    settings: &[&str],
    code: i32,
) -> (Value, Trace, String) {
    let twin = Twin::start();
    let relay = Relay::start(twin.path(), tamper);
    let records = Records::new();
    let scenario = RUNS[2].scenario();
    let mut arguments = vec!["run", &scenario, "--device", relay.device()];
    arguments.extend(TIMEOUT);
    let out = records.out();
    arguments.extend(["--out", &out]);
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    let ended = program::run(arguments).with_code(code);
    (records.summary(), records.trace(), ended.stdout)
}

fn same_run(summary: &Value) -> bool {
    summary["torque_sha256"] == RUNS[2].torque_sha256
}

fn lose_torque(frame: &Transit) -> Action {
    if frame.torque().is_some_and(|torque| torque.sequence == HIT) {
        Action::Replace(Vec::new())
    } else {
        Action::Forward
    }
}

fn held_at_hit(trace: &Trace) -> bool {
    let torque_nm = trace.column("torque_nm");
    let at = usize::from(HIT);
    // Different neighbours show that the torque is held and the drive not at rest.
    torque_nm[at] == torque_nm[at - 1]
        && torque_nm[at - 1] != torque_nm[at - 2]
        && torque_nm[at + 1] != torque_nm[at]
}

#[test]
fn a_lost_answer_holds_the_torque_and_invalidates_the_run() {
    let (summary, trace, stdout) = run_through(lose_torque, &[], 3);
    assert!(held_at_hit(&trace), "the row of the lost answer doesn't hold the torque before it");
    assert_eq!((&summary["verdict"], &summary["link"]["lost"]), (&"INVALID".into(), &1.into()));
    assert!(stdout.contains("BROKEN lost: 1 counted, allow.lost is 0"), "{stdout}");
    assert!(!same_run(&summary), "a run with a held torque is another run");
    assert_eq!(trace.len(), 25_000);
}

#[test]
fn an_allowed_lost_answer_passes() {
    let (summary, trace, _) = run_through(lose_torque, &["allow.lost=1"], 0);
    assert!(held_at_hit(&trace), "the row of the lost answer doesn't hold the torque before it");
    assert_eq!(summary["link"]["lost"], 1);
}

#[test]
fn a_lost_sample_holds_the_torque() {
    let lose = |frame: &Transit| match frame.sample() {
        Some(sample) if sample.sequence == HIT => Action::Replace(Vec::new()),
        _ => Action::Forward,
    };
    let (summary, trace, _) = run_through(lose, &[], 3);
    assert!(held_at_hit(&trace), "the row of the lost sample doesn't hold the torque before it");
    assert_eq!((&summary["link"]["lost"], &summary["link"]["damaged_at_drive"]), (&1.into(), &0.into()));
}

#[test]
fn a_late_answer_is_counted_and_discarded() {
    let mut kept = Vec::new();
    let delay = move |frame: &Transit| match frame.torque() {
        Some(torque) if torque.sequence == HIT => {
            kept.clone_from(&frame.bytes);
            Action::Replace(Vec::new())
        }
        // By now the bench has given up the sample.
        Some(torque) if torque.sequence == HIT + 1 => Action::Replace([&kept[..], &frame.bytes].concat()),
        _ => Action::Forward,
    };
    let (summary, trace, _) = run_through(delay, &["allow.lost=1"], 3);
    assert!(held_at_hit(&trace), "the late answer was used");
    assert_eq!((&summary["link"]["lost"], &summary["link"]["late"]), (&1.into(), &1.into()));
}

#[test]
fn a_torque_with_a_flipped_bit_is_counted_and_discarded() {
    let flip = |frame: &Transit| match frame.torque() {
        Some(torque) if torque.sequence == HIT => {
            let mut bytes = frame.bytes.clone();
            // A bit of the torque field that makes no byte zero: a frame of correct length with a wrong CRC.
            bytes[8] ^= if bytes[8] == 0x10 { 0x20 } else { 0x10 };
            Action::Replace(bytes)
        }
        _ => Action::Forward,
    };
    let (summary, trace, stdout) = run_through(flip, &[], 3);
    assert!(held_at_hit(&trace), "the damaged torque was used");
    assert_eq!((&summary["link"]["crc_errors"], &summary["link"]["lost"]), (&1.into(), &1.into()));
    assert!(stdout.contains("BROKEN crc_errors: 1 counted, allow.crc_errors is 0"), "{stdout}");
}

#[test]
fn the_drive_counts_a_sample_with_a_flipped_bit() {
    let flip = |frame: &Transit| match frame.sample() {
        Some(sample) if sample.sequence == HIT => {
            let mut bytes = frame.bytes.clone();
            bytes[7] ^= if bytes[7] == 0x10 { 0x20 } else { 0x10 };
            Action::Replace(bytes)
        }
        _ => Action::Forward,
    };
    let (summary, trace, _) = run_through(flip, &[], 3);
    assert!(held_at_hit(&trace), "the damaged sample was answered");
    let link = &summary["link"];
    assert_eq!(
        (&link["damaged_at_drive"], &link["lost"], &link["crc_errors"]),
        (&1.into(), &1.into(), &0.into())
    );
}

#[test]
fn a_duplicated_sample_changes_nothing() {
    let double = |frame: &Transit| match frame.sample() {
        Some(sample) if sample.sequence % 100 == 0 => Action::Replace(frame.bytes.repeat(2)),
        _ => Action::Forward,
    };
    let (summary, _, _) = run_through(double, &[], 0);
    assert!(same_run(&summary), "other torques: {summary}");
    // 25,000 samples and a stop; the drive answered 250 samples twice.
    let link = &summary["link"];
    assert_eq!((&link["lost"], &link["late"], &link["crc_errors"]), (&0.into(), &0.into(), &0.into()));
}

#[test]
fn noise_between_frames_is_counted_and_changes_no_torque() {
    let noise = |frame: &Transit| {
        let hit = frame.torque().is_some_and(|torque| torque.sequence == HIT)
            || frame.sample().is_some_and(|sample| sample.sequence == HIT);
        let garbage = [0xff, 0x07, 0x5a, 0xa5, 0x00];
        if hit { Action::Replace([&garbage[..], &frame.bytes].concat()) } else { Action::Forward }
    };
    let (summary, _, _) = run_through(noise, &["allow.crc_errors=1"], 0);
    assert!(same_run(&summary), "other torques: {summary}");
    let link = &summary["link"];
    assert_eq!(
        (&link["crc_errors"], &link["damaged_at_drive"], &link["lost"]),
        (&1.into(), &1.into(), &0.into())
    );
}
