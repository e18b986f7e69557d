//! Runs beyond the range of the numbers on the wire: sequences of 16 bits, counts of 24.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{Arm, Subscribe};

use crate::host::{Host, SESSION, torque};

/// Counts after which a reading repeats.
const RANGE: i64 = 1 << 24;

/// A run whose last sample was number 65535.
fn at_the_last_number(settings: &[(&str, ParameterValue)]) -> Host {
    let mut host = Host::running(settings);
    for sequence in 0..=u16::MAX {
        assert_eq!(flags(&host.sample(sequence, 0, 0)), TorqueFlags::empty(), "sequence {sequence}");
    }
    host
}

fn flags(answers: &[DriveMessage]) -> TorqueFlags {
    torque(answers).status.flags
}

fn is_rejected(answers: &[DriveMessage]) -> bool {
    matches!(answers, [DriveMessage::CommandResult(result)] if result.outcome == Outcome::OutOfSequence)
}

fn motor_limit(rad_s: f32) -> (&'static str, ParameterValue) {
    ("motor_speed_limit_rad_s", ParameterValue::F32(rad_s))
}

#[test]
fn sequence_0_follows_65535() {
    let mut host = at_the_last_number(&[]);
    host.send(Subscribe { signals: 1, every: 10 });
    let answers = host.sample(0, 0, 0);
    assert_eq!((torque(&answers).sequence, flags(&answers)), (0, TorqueFlags::empty()));
    assert!(matches!(answers[1], DriveMessage::Telemetry(it) if it.sequence == 0), "0 is a multiple of 10");
    assert_eq!(flags(&host.sample(0, 0, 0)), TorqueFlags::REPEATED);
    assert!(is_rejected(&host.sample(u16::MAX, 0, 0)), "an old number");
    assert_eq!(flags(&host.sample(1, 0, 0)), TorqueFlags::empty());
}

#[test]
fn the_longest_gap_may_cross_the_wraparound() {
    let slow = [motor_limit(100.0)];
    assert!(is_rejected(&at_the_last_number(&slow).sample(1000, 0, 0)), "1001 periods on");
    assert_eq!(flags(&at_the_last_number(&slow).sample(999, 0, 0)), TorqueFlags::GAP);
}

#[test]
fn the_speed_limit_bounds_the_longest_gap() {
    // 1000 rad/s are 20,861 counts in a millisecond, of 2^23.
    let cases = [
        (vec![], 402),
        (vec![motor_limit(500.0)], 804),
        (vec![motor_limit(100.0)], 1000),
        (vec![motor_limit(100.0), ("load_counts_per_rev", ParameterValue::U32(1 << 24))], 31),
        (vec![motor_limit(100.0), ("period_us", ParameterValue::U32(20_000))], 201),
    ];
    for (settings, longest) in cases {
        let mut host = Host::running(&settings);
        host.sample(0, 0, 0);
        assert!(is_rejected(&host.sample(longest + 1, 0, 0)), "{settings:?}");
        assert_eq!(flags(&host.sample(longest, 0, 0)), TorqueFlags::GAP, "{settings:?}");
    }
}

#[test]
fn the_longest_gap_at_the_speed_limit_keeps_its_direction() {
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(1000.0))]);
    host.sample(0, 0, 0);
    let far = torque(&host.sample(402, 402 * 20_860, 0));
    assert_eq!((far.status.state, far.status.flags), (State::Running, TorqueFlags::GAP));
    assert!(far.torque_nm < -400.0, "the motor is 402 rad ahead, not behind: {far:?}");
}

#[test]
fn a_speed_of_half_the_range_per_period_is_inconsistent() {
    for (limit, counts) in [
        ("motor_speed_limit_rad_s", "motor_counts_per_rev"),
        ("load_speed_limit_rad_s", "load_counts_per_rev"),
    ] {
        let mut host = Host::idle();
        host.set(counts, ParameterValue::U32(1 << 24));
        // 3142 rad/s are half a revolution in a millisecond, and half a revolution is 2^23 counts.
        host.set(limit, ParameterValue::F32(3142.0));
        let index = u32::from(<Host>::parameter(limit));
        let refusal = host.refusal(Arm { session: SESSION });
        assert_eq!(refusal, (Outcome::Inconsistent, index, State::Idle), "{limit}");
        host.set(limit, ParameterValue::F32(3141.0));
        assert_eq!(host.command(Arm { session: SESSION }), (Outcome::Accepted, State::Armed));
    }
}

/// Both runs make the same motion; only the readings of the finer encoders wrap.
#[test]
fn positions_continue_across_the_wraparound() {
    const COARSER: i64 = 16;
    for direction in [1, -1] {
        let run = |counts_per_rev: u32, counts_per_step: i64| {
            let mut host = Host::running(&[
                ("torque_limit_nm", ParameterValue::F32(1000.0)),
                ("motor_counts_per_rev", ParameterValue::U32(counts_per_rev)),
                ("load_counts_per_rev", ParameterValue::U32(counts_per_rev)),
                ("load_speed_limit_rad_s", ParameterValue::F32(1000.0)),
                ("k_p1", ParameterValue::F32(0.1)),
                ("k_p2", ParameterValue::F32(0.0)),
                ("k_d2", ParameterValue::F32(0.0)),
            ]);
            let torques: Vec<f32> = (0..3000_u16)
                .map(|step| {
                    let counts = i64::from(step) * counts_per_step * direction;
                    torque(&host.sample(step, counts, counts / 3)).torque_nm
                })
                .collect();
            torques
        };
        let (fine, coarse) = (run(1 << 17, 1125 * COARSER), run(1 << 13, 1125));
        assert!(coarse[2999].abs() > 250.0, "2577 rad of the motor: {} N m", coarse[2999]);
        for (step, (fine, coarse)) in fine.iter().zip(&coarse).enumerate() {
            assert!((fine - coarse).abs() < 0.01, "step {step}: {fine} and {coarse} N m");
        }
    }
}

#[test]
fn a_reading_that_repeats_is_not_the_same_position() {
    let mut host = Host::running(&[("torque_limit_nm", ParameterValue::F32(1000.0))]);
    let first = torque(&host.sample(0, 0, 0)).torque_nm;
    // 20,000 counts are 959 rad/s.
    let steps = RANGE / 20_000 + 1;
    (1..=steps).for_each(|step| drop(host.sample(step as u16, RANGE.min(step * 20_000), 0)));
    // The velocity filter settles within 10 ms.
    let last = (1..100).map(|step| torque(&host.sample((steps + step) as u16, RANGE, 0)).torque_nm).last();
    let moved_nm = last.expect("samples") - first;
    // K_P1 is 1 N m/rad, and 2^24 counts are 128 revolutions. The remainder is the elastic feedback.
    assert!(moved_nm < -128.0 * std::f32::consts::TAU * 0.999, "{moved_nm} N m");
}
