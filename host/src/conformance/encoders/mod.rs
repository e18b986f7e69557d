//! Encoders: where they stand, how fast they may be, and (`gaps`) how long they may go unread.

mod gaps;

use std::f64::consts::TAU;

use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::vocabulary::{FaultCode, ParameterValue, State};
use lashloop_protocol::{DriveMessage, EncoderCounts};

use super::check::{Check, Checked, Failure, equal, expect};
use super::client::{Client, sample, torque};
use super::parameters::holds;
use super::safety::{faulted, no_torque};

const PERIOD_US: u32 = 1_000;
/// Coarse enough that the largest speed in a period fits into a counter, fine enough that a count is a small part of it.
const COUNTS_PER_REV: u32 = 65_536;
const SPEED_LIMIT_RAD_S: f32 = 50.0;
/// Periods after which no sample is taken, whatever the encoders are.
const LONGEST_GAP: u16 = 1_000;
/// How much two torques may differ, as a share of the larger one, if all that differs is a count in the position. The
/// encoder then stands hundreds of radians off: a count of 96 urad, and the velocity that it makes, are nothing to that.
const SAME_TORQUE: f32 = 0.05;

/// One of the two encoders, by the names of its parameters.
#[derive(Clone, Copy)]
struct Encoder {
    name: &'static str,
    speed_limit: &'static str,
    counts_per_rev: &'static str,
    code: FaultCode,
    place: fn(&mut EncoderSample) -> &mut EncoderCounts,
}

const MOTOR: Encoder = Encoder {
    name: "motor",
    speed_limit: "motor_speed_limit_rad_s",
    counts_per_rev: "motor_counts_per_rev",
    code: FaultCode::MotorEncoderJump,
    place: |sample| &mut sample.motor_counts,
};
const LOAD: Encoder = Encoder {
    name: "load",
    speed_limit: "load_speed_limit_rad_s",
    counts_per_rev: "load_counts_per_rev",
    code: FaultCode::LoadEncoderJump,
    place: |sample| &mut sample.load_counts,
};
const BOTH: [Encoder; 2] = [MOTOR, LOAD];

type Setting = (&'static str, ParameterValue);

/// Encoders of one resolution, with speed limits for motor and load.
const fn encoders(counts_per_rev: u32, motor_rad_s: f32, load_rad_s: f32) -> [Setting; 5] {
    [
        ("period_us", ParameterValue::U32(PERIOD_US)),
        (MOTOR.counts_per_rev, ParameterValue::U32(counts_per_rev)),
        (LOAD.counts_per_rev, ParameterValue::U32(counts_per_rev)),
        (MOTOR.speed_limit, ParameterValue::F32(motor_rad_s)),
        (LOAD.speed_limit, ParameterValue::F32(load_rad_s)),
    ]
}

/// For checks that leave samples out, whatever encoders the drive has by default: up to 128,000 rad/s these allow gaps of
/// 100 periods.
pub(super) const COARSE: [Setting; 3] = [
    ("period_us", ParameterValue::U32(PERIOD_US)),
    (MOTOR.counts_per_rev, ParameterValue::U32(4_096)),
    (LOAD.counts_per_rev, ParameterValue::U32(4_096)),
];

pub(super) fn checks() -> Vec<Check> {
    let check = |name, run: fn(&mut Client) -> Checked| Check::new("encoders", name, run);
    let mut checks = vec![
        check("an encoder within its speed limit is believed", |client| {
            for (encoder, share) in [(MOTOR, 0.9), (MOTOR, -0.9), (LOAD, 0.9), (LOAD, -0.9)] {
                let answer = torque(&moved(client, encoder, share)?.0)?;
                equal(
                    &format!("{} at {share} of its limit: state", encoder.speed_limit),
                    State::Running,
                    answer.status.state,
                )?;
            }
            Ok(())
        }),
        check("an encoder that wraps around goes on where it was", |client| {
            let (top, bottom) = (i64::from(EncoderCounts::MAX.get()), i64::from(EncoderCounts::MIN.get()));
            BOTH.into_iter().try_for_each(|encoder| {
                alike(client, encoder, &[(0, top), (1, top + 1)], &[(0, top - 1), (1, top)])?;
                alike(client, encoder, &[(0, bottom), (1, bottom - 1)], &[(0, bottom + 1), (1, bottom)])
            })
        }),
        check("an encoder may go further than half its range from its first reading", |client| {
            // From a quarter of the range below zero to one above: no reading wraps, what would is the way as a whole.
            let way = |sign: i64, more: i64| {
                let mut way = [(0, 0); 33];
                for (step, at) in (0_i32..).zip(&mut way) {
                    *at = (step as u16 * LONGEST_GAP, sign * (i64::from(step - 16) << 18));
                }
                way[32].1 += sign * more;
                way
            };
            BOTH.into_iter().try_for_each(|encoder| {
                [1, -1].into_iter().try_for_each(|sign| alike(client, encoder, &way(sign, 1), &way(sign, -1)))
            })
        }),
    ];
    checks.extend(BOTH.into_iter().map(|encoder| {
        let name = format!("a {} encoder that jumps is a fault", encoder.name);
        Check::new("encoders", name, move |client| {
            [1.5, -1.5].into_iter().try_for_each(|share| jump(client, encoder, share))
        })
    }));
    checks.extend(gaps::checks());
    checks
}

/// A sample with one encoder at so many counts from zero, and the other at zero.
fn placed(encoder: Encoder, sequence: u16, counts: i64) -> EncoderSample {
    let mut sample = sample(sequence);
    *(encoder.place)(&mut sample) = EncoderCounts::wrapping(counts);
    sample
}

/// Holds the torque at the end of one way of an encoder against that at the end of another, which ends two counts
/// earlier at most. A way is made of sequences and counts.
///
/// No control law is known here, so no torque is either. But a law that goes by position pushes hard so far from its
/// reference, to its limit perhaps, and a count more is nothing to it; only one that takes the position for another, a
/// whole range of counts away on the other side of zero, pushes the other way.
fn alike(client: &mut Client, encoder: Encoder, way: &[(u16, i64)], earlier: &[(u16, i64)]) -> Checked {
    let wanted_nm = at_the_end(client, encoder, earlier)?;
    let came_nm = at_the_end(client, encoder, way)?;
    let near = (came_nm - wanted_nm).abs() <= SAME_TORQUE * came_nm.abs().max(wanted_nm.abs());
    let last = |way: &[(u16, i64)]| way.last().map_or(0, |it| it.1);
    let expected = format!(
        "with the {} at {} counts {wanted_nm} N m to {} %, the torque at {} counts",
        encoder.name,
        last(way),
        100.0 * SAME_TORQUE,
        last(earlier)
    );
    expect(near, expected, came_nm)
}

/// The torque at the end of a way.
fn at_the_end(client: &mut Client, encoder: Encoder, way: &[(u16, i64)]) -> Result<f32, Failure> {
    client.fresh()?;
    running(client, &encoders(COUNTS_PER_REV, SPEED_LIMIT_RAD_S, SPEED_LIMIT_RAD_S))?;
    let mut torque_nm = 0.0;
    for &(sequence, counts) in way {
        let answer = torque(&client.say(placed(encoder, sequence, counts))?)?;
        let what = format!("{} at {counts} counts: state", encoder.name);
        equal(&what, State::Running, answer.status.state)?;
        torque_nm = answer.torque_nm;
    }
    Ok(torque_nm)
}

/// Leaves the check out if the drive's ranges don't hold these settings: which ones it offers is its own affair.
fn allowed(client: &Client, settings: &[Setting]) -> Checked {
    for (name, value) in settings {
        if !holds(client.parameter(name)?, *value) {
            return Err(Failure::LeftOut {
                reason: "not run: the drive takes no such encoders, period or speed limits",
            });
        }
    }
    Ok(())
}

fn running(client: &mut Client, settings: &[Setting]) -> Checked {
    allowed(client, settings)?;
    client.running(settings)
}

/// Moves one encoder by a share of what its speed limit allows in a period; returns the answers and the speed in rad/s.
fn moved(client: &mut Client, encoder: Encoder, share: f32) -> Result<(Vec<DriveMessage>, f32), Failure> {
    client.fresh()?;
    running(client, &encoders(COUNTS_PER_REV, SPEED_LIMIT_RAD_S, SPEED_LIMIT_RAD_S))?;
    client.torque(0)?;
    let per_count = speed_per_count_rad_s(COUNTS_PER_REV) as f32;
    let counts = (share * SPEED_LIMIT_RAD_S / per_count) as i64;
    Ok((client.say(placed(encoder, 1, counts))?, counts as f32 * per_count))
}

/// What one count in a period means.
fn speed_per_count_rad_s(counts_per_rev: u32) -> f64 {
    TAU / f64::from(counts_per_rev) / (f64::from(PERIOD_US) * 1e-6)
}

fn jump(client: &mut Client, encoder: Encoder, share: f32) -> Checked {
    let (answers, speed_rad_s) = moved(client, encoder, share)?;
    let it = faulted(&answers, encoder.code)?;
    equal("sequence and limit", (1, SPEED_LIMIT_RAD_S), (it.sequence, it.limit))?;
    // Which way it turned need not be said, and an encoder that shows one count more may have turned hardly at all.
    let (value, speed_rad_s) = (it.value.abs(), speed_rad_s.abs());
    let near = (value - speed_rad_s).abs() <= 1.01 * speed_per_count_rad_s(COUNTS_PER_REV) as f32;
    expect(near, format!("the speed {speed_rad_s} rad/s, to a count in a period"), it.value)?;
    no_torque(client, 2, State::Faulted)
}
