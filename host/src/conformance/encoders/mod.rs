//! Encoders: where they stand, how fast they may be, and (`gaps`) how long they may go unread.

mod encoder;
mod gaps;
pub(super) mod setup;

use lashloop_protocol::enums::State;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::{DriveMessage, EncoderCounts};

use encoder::Encoder;
use setup::Setup;

use super::answers::{sample, torque};
use super::assertion::{Failure, RuleResult, equal, expect};
use super::check::Check;
use super::client::Client;
use super::reactions::{fault_answer, no_torque};

/// Samples that a way may take. A run of so many lasts seconds on a slow line.
const LONGEST_WAY: i64 = 2_048;
/// How much two torques may differ, as a share of the larger one, if all that differs is a count in the position. The
/// encoder then stands millions of counts off: one more, and the velocity that it makes, are nothing to that.
const SAME_TORQUE: f32 = 0.05;

pub(super) fn checks() -> Vec<Check> {
    let check = |name, run: fn(&mut Client) -> RuleResult| Check::new("encoders", name, run);
    let mut checks = vec![
        check("an encoder within its speed limit is accepted", |client| {
            for (encoder, sign) in
                [(Encoder::Motor, 1), (Encoder::Motor, -1), (Encoder::Load, 1), (Encoder::Load, -1)]
            {
                let setup = Setup::coarse(client)?;
                let limit_counts = setup.scale(encoder).counts_per_period();
                // One count more than it has turned is no fault of an encoder.
                let counts = sign * ((0.9 * limit_counts) as i64 + 1);
                let answer = torque(&moved(client, &setup, encoder, counts)?)?;
                let what = format!("{} {counts} counts on, of {limit_counts} allowed: state", encoder.name());
                equal(&what, State::Running, answer.status.state)?;
            }
            Ok(())
        }),
        check("an encoder continues through its wraparound", |client| {
            let (top, bottom) = (i64::from(EncoderCounts::MAX.get()), i64::from(EncoderCounts::MIN.get()));
            Encoder::BOTH.into_iter().try_for_each(|encoder| {
                alike(client, encoder, &[(0, top), (1, top + 1)], &[(0, top - 1), (1, top)])?;
                alike(client, encoder, &[(0, bottom), (1, bottom - 1)], &[(0, bottom + 1), (1, bottom)])
            })
        }),
        check("an encoder may travel more than half its range from its first reading", |client| {
            Encoder::BOTH.into_iter().try_for_each(|encoder| {
                [1, -1].into_iter().try_for_each(|sign| {
                    let [further, earlier] = [1, -1].map(|more| far_way(client, encoder, sign, more));
                    alike(client, encoder, &further?, &earlier?)
                })
            })
        }),
    ];
    checks.extend(Encoder::BOTH.into_iter().map(|encoder| {
        let name = format!("a {} encoder that jumps is a fault", encoder.name());
        Check::new("encoders", name, move |client| {
            [1, -1].into_iter().try_for_each(|sign| jump(client, encoder, sign))
        })
    }));
    checks.extend(gaps::checks());
    checks
}

/// A sample with one encoder at so many counts from zero, and the other at zero.
fn placed(encoder: Encoder, sequence: u16, counts: i64) -> EncoderSample {
    let mut sample = sample(sequence);
    *encoder.counts_mut(&mut sample) = EncoderCounts::wrapping(counts);
    sample
}

/// From a quarter of the range below zero to one above it and a little more, in the gaps that the drive takes. No reading
/// wraps, what would is the way as a whole.
fn far_way(client: &Client, encoder: Encoder, sign: i64, more: i64) -> Result<Vec<(u16, i64)>, Failure> {
    const QUARTER: i64 = 1 << 22;
    let setup = Setup::coarse(client)?;
    let gap = setup.longest_gap();
    // Half as fast as it may be.
    let allowed_counts = setup.scale(encoder).counts_per_period() * f64::from(gap);
    let stride = ((0.5 * allowed_counts) as i64).clamp(1, QUARTER / 16);
    let strides = (2 * QUARTER + stride - 1) / stride;
    if strides > LONGEST_WAY {
        return Err(Failure::Skipped {
            reason: "not run: at the highest speed limits that the drive takes the way lasts too long",
        });
    }
    let at = |step| if step == strides { QUARTER + more } else { step * stride - QUARTER };
    let sequence = |step: i64| (step as u16).wrapping_mul(gap);
    Ok((0..=strides).map(|step| (sequence(step), sign * at(step))).collect())
}

/// Holds the torque at the end of one way of an encoder against that at the end of another, which ends two counts
/// earlier at most. A way is made of sequences and counts.
///
/// No control law is known here, so no torque is either. But a law that goes by position pushes hard so far from its
/// reference, to its limit perhaps, and a count more is nothing to it; only one that takes the position for another, a
/// whole range of counts away on the other side of zero, pushes the other way.
fn alike(client: &mut Client, encoder: Encoder, way: &[(u16, i64)], earlier: &[(u16, i64)]) -> RuleResult {
    let wanted_nm = at_the_end(client, encoder, earlier)?;
    let came_nm = at_the_end(client, encoder, way)?;
    let near = (came_nm - wanted_nm).abs() <= SAME_TORQUE * came_nm.abs().max(wanted_nm.abs());
    let last = |way: &[(u16, i64)]| way.last().map_or(0, |it| it.1);
    let expected = format!(
        "with the {} at {} counts {wanted_nm} N m to {} %, the torque at {} counts",
        encoder.name(),
        last(way),
        100.0 * SAME_TORQUE,
        last(earlier)
    );
    expect(near, expected, came_nm)
}

/// The torque at the end of a way.
fn at_the_end(client: &mut Client, encoder: Encoder, way: &[(u16, i64)]) -> Result<f32, Failure> {
    client.reset()?;
    Setup::coarse(client)?.start(client)?;
    let mut torque_nm = 0.0;
    for &(sequence, counts) in way {
        let answer = torque(&client.request(placed(encoder, sequence, counts))?)?;
        let what = format!("{} at {counts} counts: state", encoder.name());
        equal(&what, State::Running, answer.status.state)?;
        torque_nm = answer.torque_nm;
    }
    Ok(torque_nm)
}

/// Moves one encoder by so many counts in a period.
fn moved(
    client: &mut Client,
    setup: &Setup,
    encoder: Encoder,
    counts: i64,
) -> Result<Vec<DriveMessage>, Failure> {
    client.reset()?;
    setup.start(client)?;
    client.torque(0)?;
    client.request(placed(encoder, 1, counts))
}

fn jump(client: &mut Client, encoder: Encoder, sign: i64) -> RuleResult {
    let setup = Setup::coarse(client)?;
    let scale = setup.scale(encoder);
    let counts = scale.jump_counts()?;
    let answers = moved(client, &setup, encoder, sign * counts)?;
    let it = fault_answer(&answers, encoder.jump_fault())?;
    equal("sequence and limit", (1, scale.speed_limit_rad_s), (it.sequence, it.limit))?;
    // Which way it turned need not be said, and an encoder that shows one count more may have turned hardly at all.
    let per_count_rad_s = scale.speed_per_count_rad_s();
    let speed_rad_s = counts as f64 * per_count_rad_s;
    let off_rad_s = (f64::from(it.value.abs()) - speed_rad_s).abs();
    let rounding_rad_s = f64::from(4.0 * f32::EPSILON) * speed_rad_s;
    let near = off_rad_s <= 1.01 * per_count_rad_s + rounding_rad_s;
    expect(near, format!("the speed {speed_rad_s} rad/s, to a count in a period"), it.value)?;
    no_torque(client, 2, State::Faulted)
}
