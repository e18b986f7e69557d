//! Encoders: wraparound, range, speed limit and (`gaps`) longest gap.

mod encoder;
mod gaps;
pub(super) mod setup;

use lashloop_protocol::enums::State;
use lashloop_protocol::message::EncoderSample;
use lashloop_protocol::{DriveMessage, EncoderCounts};

use encoder::Encoder;
use setup::Setup;

use super::answers::{sample, torque};
use super::assertion::{Failure, RuleResult, equal, expect, skip};
use super::check::{Check, check};
use super::client::Client;
use super::reactions::{fault_answer, no_torque};

/// Most samples of one path. Such a run lasts seconds on a slow line.
const LONGEST_PATH: i64 = 2_048;
/// Tolerated difference of two torques whose positions differ by a count, as a fraction of the larger. The position error
/// is millions of counts, so one count and its velocity are negligible.
const SAME_TORQUE: f32 = 0.05;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R7", "an encoder within its speed limit is accepted", |client| {
            for (encoder, sign) in
                [(Encoder::MOTOR, 1), (Encoder::MOTOR, -1), (Encoder::LOAD, 1), (Encoder::LOAD, -1)]
            {
                let setup = Setup::coarse(client)?;
                let limit_counts = setup.scale(encoder).counts_per_period();
                // One count of quantisation is within the limit.
                let counts = sign * ((0.9 * limit_counts) as i64 + 1);
                let answer = torque(&moved(client, &setup, encoder, counts)?)?;
                let what = format!("{} {counts} counts on, of {limit_counts} allowed: state", encoder.name);
                equal(&what, State::Running, answer.status.state)?;
            }
            Ok(())
        }),
        check("R7", "an encoder continues through its wraparound", |client| {
            let (top, bottom) = (i64::from(EncoderCounts::MAX.get()), i64::from(EncoderCounts::MIN.get()));
            Encoder::BOTH.into_iter().try_for_each(|encoder| {
                alike(client, encoder, &[(0, top), (1, top + 1)], &[(0, top - 1), (1, top)])?;
                alike(client, encoder, &[(0, bottom), (1, bottom - 1)], &[(0, bottom + 1), (1, bottom)])
            })
        }),
        check("R7", "an encoder may travel more than half its range from its first reading", |client| {
            Encoder::BOTH.into_iter().try_for_each(|encoder| {
                [1, -1].into_iter().try_for_each(|sign| {
                    let [further, earlier] = [1, -1].map(|more| long_path(client, encoder, sign, more));
                    alike(client, encoder, &further?, &earlier?)
                })
            })
        }),
    ];
    checks.extend(Encoder::BOTH.into_iter().map(|encoder| {
        let name = format!("a {} encoder that jumps is a fault", encoder.name);
        check("R7", name, move |client| [1, -1].into_iter().try_for_each(|sign| jump(client, encoder, sign)))
    }));
    checks.extend(gaps::checks());
    checks
}

/// A sample with one encoder at `counts` and the other at zero.
fn placed(encoder: Encoder, sequence: u16, counts: i64) -> EncoderSample {
    let mut sample = sample(sequence);
    *(encoder.counts_mut)(&mut sample) = EncoderCounts::wrapping(counts);
    sample
}

/// A path from a quarter of the range below zero to just above a quarter above zero, in the gaps of the drive. No reading
/// wraps around, but the distance exceeds half the range.
fn long_path(client: &Client, encoder: Encoder, sign: i64, more: i64) -> Result<Vec<(u16, i64)>, Failure> {
    const QUARTER: i64 = 1 << 22;
    let setup = Setup::coarse(client)?;
    let gap = setup.longest_gap();
    // Half the speed limit.
    let allowed_counts = setup.scale(encoder).counts_per_period() * f64::from(gap);
    let stride = ((0.5 * allowed_counts) as i64).clamp(1, QUARTER / 16);
    let strides = (2 * QUARTER + stride - 1) / stride;
    if strides > LONGEST_PATH {
        return skip("not run: with the highest speed limits of this drive the path takes too many samples");
    }
    let at = |step| if step == strides { QUARTER + more } else { step * stride - QUARTER };
    let sequence = |step: i64| (step as u16).wrapping_mul(gap);
    Ok((0..=strides).map(|step| (sequence(step), sign * at(step))).collect())
}

/// Requires nearly equal torques at the ends of two paths, which lie at most two counts apart. A path is a list of sequence
/// and counts.
///
/// The control law is unknown, and so is its torque. So far from the reference, a law with position feedback requests a
/// large torque, on which one count has no effect. A position wrong by the whole range lies on the other side of zero and
/// reverses the torque.
fn alike(client: &mut Client, encoder: Encoder, path: &[(u16, i64)], earlier: &[(u16, i64)]) -> RuleResult {
    let wanted_nm = at_the_end(client, encoder, earlier)?;
    let came_nm = at_the_end(client, encoder, path)?;
    let near = (came_nm - wanted_nm).abs() <= SAME_TORQUE * came_nm.abs().max(wanted_nm.abs());
    let last = |path: &[(u16, i64)]| path.last().map_or(0, |it| it.1);
    let expected = format!(
        "with the {} at {} counts {wanted_nm} N m to {} %, the torque at {} counts",
        encoder.name,
        last(path),
        100.0 * SAME_TORQUE,
        last(earlier)
    );
    expect(near, expected, came_nm)
}

/// The torque at the end of a path.
fn at_the_end(client: &mut Client, encoder: Encoder, path: &[(u16, i64)]) -> Result<f32, Failure> {
    client.reset()?;
    Setup::coarse(client)?.start(client)?;
    let mut torque_nm = 0.0;
    for &(sequence, counts) in path {
        let answer = torque(&client.request(placed(encoder, sequence, counts))?)?;
        let what = format!("{} at {counts} counts: state", encoder.name);
        equal(&what, State::Running, answer.status.state)?;
        torque_nm = answer.torque_nm;
    }
    Ok(torque_nm)
}

/// Moves one encoder by `counts` in one period.
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
    let it = fault_answer(&answers, encoder.jump_fault)?;
    equal("sequence and limit", (1, scale.speed_limit_rad_s), (it.sequence, it.limit))?;
    // The report may omit the sign, and one count of quantisation adds to the speed.
    let per_count_rad_s = scale.speed_per_count_rad_s();
    let speed_rad_s = counts as f64 * per_count_rad_s;
    let off_rad_s = (f64::from(it.value.abs()) - speed_rad_s).abs();
    let rounding_rad_s = f64::from(4.0 * f32::EPSILON) * speed_rad_s;
    let near = off_rad_s <= 1.01 * per_count_rad_s + rounding_rad_s;
    expect(near, format!("the speed {speed_rad_s} rad/s, to a count in a period"), it.value)?;
    no_torque(client, 2, State::Faulted)
}
