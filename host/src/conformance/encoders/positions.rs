//! Positions: first readings of either sign, and any number of wraparounds.

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::TorqueFlags;
use lashloop_protocol::message::Stop;

use super::encoder::{Encoder, placed};
use super::setup::Setup;

use crate::conformance::assertion::{Failure, RuleResult, expect, skip};
use crate::conformance::check::{Check, check};
use crate::conformance::client::Client;
use crate::conformance::reactions::accepted;

/// Half the range of a reading, in counts.
const HALF: i64 = 1 << 23;
/// Most samples of one path. Such a run lasts a second on a slow line.
const LONGEST_PATH: i64 = 300;
/// Periods of rest after a motion.
const REST: u16 = 20;
/// Why a position reached in two ways shows nothing.
const WITH_MEMORY: &str = "not run: the torque of the law in force depends on the way to a position";
/// Tolerated difference of two torques whose positions differ by two counts, as a fraction of the larger.
const SAME_TORQUE: f32 = 0.05;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R7.7 R7.8 R10.5", "an encoder continues through its wraparound", |client| {
            let (top, bottom) = (i64::from(EncoderCounts::MAX.get()), i64::from(EncoderCounts::MIN.get()));
            Encoder::BOTH.into_iter().try_for_each(|encoder| {
                alike(client, encoder, &[(0, top), (1, top + 1)], &[(0, top - 1), (1, top)])?;
                alike(client, encoder, &[(0, bottom), (1, bottom - 1)], &[(0, bottom + 1), (1, bottom)])
            })
        }),
        check(
            "R7.8 R10.5",
            "an encoder may travel more than half its range from its first reading",
            |client| each_way(client, -HALF / 2, HALF / 2),
        ),
        check("R7.8 R10.5", "an encoder may wrap around more than once", |client| {
            each_way(client, HALF / 2, 3 * HALF)
        }),
        check("R7.7 R7.8", "a run that starts at a position goes on as one that has moved there", |client| {
            Encoder::BOTH.into_iter().try_for_each(|encoder| started_or_moved(client, encoder))
        }),
        check("R7.7 R7.14 R7.17", "the first sample of a run has no predecessor", |client| {
            let setup = Setup::coarse(client)?;
            for encoder in Encoder::BOTH {
                // The torques of first samples after a reset, and then one after the other.
                let places = [HALF / 2, -HALF, HALF - 1, -1, 1];
                let fresh = places.map(|counts| {
                    client.reset()?;
                    setup.start(client)?;
                    accepted(client, placed(encoder, 0, counts), TorqueFlags::empty())
                });
                for (counts, fresh) in places.into_iter().zip(fresh) {
                    let wanted_nm = fresh?.torque_nm;
                    client.command(Stop {})?;
                    client.arm()?;
                    client.start()?;
                    let first = accepted(client, placed(encoder, 0, counts), TorqueFlags::empty())?;
                    let expected = format!("{} at {counts} counts: {wanted_nm} N m", encoder.name);
                    expect(first.torque_nm.to_bits() == wanted_nm.to_bits(), expected, first.torque_nm)?;
                    accepted(client, placed(encoder, 1, counts), TorqueFlags::empty())?;
                }
            }
            Ok(())
        }),
    ]
}

/// Travels with each encoder from `start` to the counts around `end`, and the same with the opposite sign.
fn each_way(client: &mut Client, start: i64, end: i64) -> RuleResult {
    Encoder::BOTH.into_iter().try_for_each(|encoder| {
        [1, -1].into_iter().try_for_each(|sign| {
            // The same path but for its end.
            let further = path(client, sign, start, end + 1)?;
            let mut earlier = further.clone();
            if let Some((_, counts)) = earlier.last_mut() {
                *counts -= 2 * sign;
            }
            alike(client, encoder, &further, &earlier)
        })
    })
}

/// A position reached from either side, and one at which the run started. Of a law with memory the torque depends on the way:
/// then the torques of the two ways differ, or the torque changes at rest.
fn started_or_moved(client: &mut Client, encoder: Encoder) -> RuleResult {
    let end = HALF / 2;
    let mut ways = [path(client, 1, 0, end)?, path(client, 1, HALF - 1, end)?];
    ways.iter_mut().for_each(hold);
    let mut torques_nm = [0.0; 2];
    for (torque_nm, way) in torques_nm.iter_mut().zip(&ways) {
        let at_rest = &way[..way.len() - 1];
        let earlier_nm = at_the_end(client, encoder, at_rest)?;
        *torque_nm = at_the_end(client, encoder, way)?;
        if earlier_nm.to_bits() != torque_nm.to_bits() {
            return skip(WITH_MEMORY);
        }
    }
    if torques_nm[0].to_bits() != torques_nm[1].to_bits() {
        return skip(WITH_MEMORY);
    }
    [1, -1].into_iter().try_for_each(|sign| {
        let mut moved = path(client, sign, 0, end)?;
        hold(&mut moved);
        // As many samples, for a law with a soft start.
        let started: Vec<_> = moved.iter().map(|(sequence, _)| (*sequence, sign * end)).collect();
        alike(client, encoder, &started, &moved)
    })
}

/// A path from `start` up to `end` in the gaps of the drive, with both counts times `sign`.
fn path(client: &Client, sign: i64, start: i64, end: i64) -> Result<Vec<(u16, i64)>, Failure> {
    let setup = Setup::fast(client)?;
    let gap = setup.longest_gap();
    // Half the speed limit of the slower encoder.
    let allowed_counts = setup.scales.map(|it| it.counts_per_period() * f64::from(gap));
    let stride = ((0.5 * allowed_counts[0].min(allowed_counts[1])) as i64).clamp(1, HALF / 2);
    let strides = ((end - start).abs() + stride - 1) / stride;
    let stride = stride * (end - start).signum();
    if strides > LONGEST_PATH {
        return skip("not run: with the highest speed limits of this drive the path takes too many samples");
    }
    let at = |step| if step == strides { end } else { start + step * stride };
    let sequence = |step: i64| (step as u16).wrapping_mul(gap);
    Ok((0..=strides).map(|step| (sequence(step), sign * at(step))).collect())
}

/// Lets an encoder rest at the end of a path until the velocities of its motion have decayed.
fn hold(path: &mut Vec<(u16, i64)>) {
    if let Some(&(sequence, counts)) = path.last() {
        path.extend((1..=REST).map(|period| (sequence.wrapping_add(period), counts)));
    }
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
    expect(near, expected, format!("{came_nm} N m"))
}

/// The torque at the end of a path. So far from zero one period at the speed limit still passes.
fn at_the_end(client: &mut Client, encoder: Encoder, path: &[(u16, i64)]) -> Result<f32, Failure> {
    client.reset()?;
    let setup = Setup::fast(client)?;
    setup.start(client)?;
    let mut torque_nm = 0.0;
    let mut last = None;
    for &(sequence, counts) in path {
        let is_next = last.is_none_or(|last: u16| last.wrapping_add(1) == sequence);
        let flags = if is_next { TorqueFlags::empty() } else { TorqueFlags::GAP };
        torque_nm = accepted(client, placed(encoder, sequence, counts), flags)?.torque_nm;
        last = Some(sequence);
    }
    if let Some(&(sequence, counts)) = path.last() {
        let further = counts + setup.scale(encoder).most_counts(1);
        accepted(client, placed(encoder, sequence.wrapping_add(1), further), TorqueFlags::empty())?;
    }
    Ok(torque_nm)
}
