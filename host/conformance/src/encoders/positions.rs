//! Positions: first readings of either sign, and any number of wraparounds.

use super::setup::{EQUAL, FAST};
use crate::prelude::checks::*;

/// Half the range of a reading, in counts.
const HALF: i64 = 1 << 23;
/// Most samples of one path. Such a run lasts a second on a slow line.
const LONGEST_PATH: i64 = 300;
/// Periods of rest after a motion, and after one whose velocity must leave no trace.
const REST: u16 = 20;
const LONG_REST: u16 = 80;
/// Samples of a slow movement, and its counts for each.
const CREEPS: u16 = 400;
const CREEP: i64 = 3;
/// Laws that are tried at most.
const MOST_LAWS: usize = 4;
/// Why a position reached in two ways shows nothing.
const WITH_MEMORY: &str = "not run: the torque of the law in force depends on the way to a position";
/// Tolerated difference of two torques whose positions differ by two counts, as a fraction of the larger.
const SAME_TORQUE: f32 = 0.05;
/// Of two torques at rest at the same position.
const SAME_PLACE: f32 = 1e-3;

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
            each_way(client, HALF / 2, 3 * HALF)?;
            // The bounds of a position in 25, 26, 27, 28 and 31 bits, or in 32 bits with some of a fraction.
            let bounds = [2, 4, 8, 16, 128].map(|halves| halves * HALF);
            for bound in &bounds[..client.repetitions(bounds.len())] {
                for encoder in Encoder::BOTH {
                    let [further, earlier] = [1, -1].map(|more| path(client, 1, HALF / 2, bound + more));
                    match (further, earlier) {
                        // The way there takes too many samples.
                        (Err(Failure::Skipped { .. }), _) if *bound > 8 * HALF => return Ok(()),
                        (further, earlier) => alike(client, encoder, &further?, &earlier?)?,
                    }
                }
            }
            Ok(())
        }),
        check("R7.8", "far from zero no count of a slow movement is lost", creeping),
        check(
            "R7.7 R7.8",
            "a run that starts at a position continues as one that has moved there",
            |client| Encoder::BOTH.into_iter().try_for_each(|encoder| started_or_moved(client, encoder)),
        ),
        check("R7.7 R7.14 R7.17", "the first sample of a run has no predecessor", |client| {
            let setup = Setup::coarse(client)?;
            for encoder in Encoder::BOTH {
                // The torques of first samples after a reset, and then one after the other.
                let places = [HALF / 2, -HALF, HALF - 1, -1, 1];
                let fresh = places.map(|counts| {
                    client.reset()?;
                    setup.start(client)?;
                    accepted(client, placed(encoder, 0, counts), NONE)
                });
                for (counts, fresh) in places.into_iter().zip(fresh) {
                    let wanted_nm = fresh?.torque_nm;
                    client.command(Stop {})?;
                    client.arm_and_start()?;
                    let first = accepted(client, placed(encoder, 0, counts), NONE)?;
                    let expected = format!("{} at {counts} counts: {wanted_nm} N m", encoder.name);
                    expect(first.torque_nm.to_bits() == wanted_nm.to_bits(), expected, first.torque_nm)?;
                    accepted(client, placed(encoder, 1, counts), NONE)?;
                }
            }
            Ok(())
        }),
    ]
}

/// Sequences and counts.
type Path = Vec<(u16, i64)>;

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

/// A position reached in two ways from zero, and one at which the run started. Of a law with memory the torque depends on the
/// way: then the torques of the two ways differ, or the torque changes at rest.
fn started_or_moved(client: &mut Client, encoder: Encoder) -> RuleResult {
    let end = HALF / 2;
    let direct = held(path(client, 1, 0, end)?, REST);
    let detour = detour(client, &Setup::of(client, &FAST)?, 0, end)?;
    let [earlier_nm, moved_nm] = at_the_end(client, encoder, &direct)?;
    let detoured_nm = at_the_end(client, encoder, &held(detour, REST))?[1];
    if [earlier_nm, detoured_nm].iter().any(|torque_nm| torque_nm.to_bits() != moved_nm.to_bits()) {
        return skip(WITH_MEMORY);
    }
    [1, -1].into_iter().try_for_each(|sign| {
        let moved: Vec<_> = direct.iter().map(|(sequence, counts)| (*sequence, sign * counts)).collect();
        // As many samples, for a law with a soft start.
        let started: Vec<_> = moved.iter().map(|(sequence, _)| (*sequence, sign * end)).collect();
        let wanted_nm = if sign == 1 { moved_nm } else { at_the_end(client, encoder, &moved)?[1] };
        near(client, encoder, (&started, sign * end), (wanted_nm, sign * end))
    })
}

/// In the first law that shows it.
fn creeping(client: &mut Client) -> RuleResult {
    if client.repetitions(CREEPS.into()) < CREEPS.into() {
        return skip("not judged: this line is too slow");
    }
    if client.parameter(CONTROLLER).is_err() {
        return creeping_in(client, None);
    }
    let laws: Vec<_> = client.description.laws.iter().map(|it| it.index).take(MOST_LAWS).collect();
    let mut ended = skip(WITH_MEMORY);
    for law in laws {
        ended = creeping_in(client, Some(law));
        if !matches!(ended, Err(Failure::Skipped { .. })) {
            break;
        }
    }
    ended
}

/// Both encoders, of one resolution, far away and near the reference: three counts a sample must add up. A law whose torque at rest
/// depends on the way shows nothing.
fn creeping_in(client: &mut Client, law: Option<u8>) -> RuleResult {
    let setup = Setup { law, ..Setup::of(client, &EQUAL)? };
    let (far, end) = (8 * HALF, 8 * HALF + CREEP * i64::from(CREEPS));
    let reference_rad = setup.angle_rad(end) as f32 - 1.0;
    let direct = path_of(client, &setup, 1, HALF / 2, end)?;
    let detour = detour(client, &setup, HALF / 2, end)?;
    let mut crept = path_of(client, &setup, 1, HALF / 2, far)?;
    let arrived = crept.last().map_or(0, |it| it.0);
    crept.extend((1..=CREEPS).map(|step| (arrived.wrapping_add(step), far + CREEP * i64::from(step))));
    let [wanted_nm, detoured_nm, crept_nm] =
        [direct, detour, crept].map(|path| at_rest(client, &setup, path, reference_rad));
    let (wanted_nm, detoured_nm, crept_nm) = (wanted_nm?, detoured_nm?, crept_nm?);
    if wanted_nm.to_bits() != detoured_nm.to_bits() {
        return skip(WITH_MEMORY);
    }
    let is_near = (crept_nm - wanted_nm).abs() <= SAME_PLACE * crept_nm.abs().max(wanted_nm.abs());
    let expected = format!("at {end} counts, with the last {CREEPS} samples 3 counts apart, {wanted_nm} N m");
    expect(is_near, expected, format!("{crept_nm} N m"))
}

/// The torque at the end of a path of both encoders, once its velocities have decayed.
fn at_rest(client: &mut Client, setup: &Setup, path: Path, reference_rad: f32) -> Result<f32, Failure> {
    client.reset()?;
    setup.start(client)?;
    let (mut torque_nm, mut last) = (0.0, None);
    for (sequence, counts) in held(path, LONG_REST) {
        let is_next = last.is_none_or(|last: u16| last.wrapping_add(1) == sequence);
        let flags = if is_next { NONE } else { TorqueFlags::GAP };
        let [motor_counts, load_counts] = [EncoderCounts::wrapping(counts); 2];
        let sample = EncoderSample { sequence, motor_counts, load_counts, reference_rad };
        torque_nm = accepted(client, sample, flags)?.torque_nm;
        last = Some(sequence);
    }
    Ok(torque_nm)
}

/// A path from `start` beyond `end`, and back to it.
fn detour(client: &Client, setup: &Setup, start: i64, end: i64) -> Result<Path, Failure> {
    let turn = end + HALF / 4;
    let mut path = path_of(client, setup, 1, start, turn)?;
    let arrived = path.last().map_or(0, |it| it.0);
    let back = path_of(client, setup, 1, turn, end)?;
    path.extend(back.into_iter().skip(1).map(|(step, counts)| (arrived.wrapping_add(step), counts)));
    Ok(path)
}

/// A path from `start` up to `end` in the gaps of the drive, with both counts times `sign`.
fn path(client: &Client, sign: i64, start: i64, end: i64) -> Result<Path, Failure> {
    path_of(client, &Setup::of(client, &FAST)?, sign, start, end)
}

/// As [`path`], with these settings.
fn path_of(client: &Client, setup: &Setup, sign: i64, start: i64, end: i64) -> Result<Path, Failure> {
    setup.allowed(client)?;
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

/// A path, and rest at its end until the velocities of the motion have decayed.
fn held(mut path: Path, periods: u16) -> Path {
    if let Some(&(sequence, counts)) = path.last() {
        path.extend((1..=periods).map(|period| (sequence.wrapping_add(period), counts)));
    }
    path
}

/// Requires nearly equal torques at the ends of two paths, which lie at most two counts apart. A path is a list of sequence
/// and counts.
///
/// The control law is unknown, and so is its torque. So far from the reference, a law with position feedback requests a
/// large torque, on which one count has no effect. A position wrong by the whole range lies on the other side of zero and
/// reverses the torque.
fn alike(client: &mut Client, encoder: Encoder, path: &[(u16, i64)], earlier: &[(u16, i64)]) -> RuleResult {
    let last = |path: &[(u16, i64)]| path.last().map_or(0, |it| it.1);
    let wanted_nm = at_the_end(client, encoder, earlier)?[1];
    near(client, encoder, (path, last(path)), (wanted_nm, last(earlier)))
}

/// Requires nearly this torque, as at these counts, at the end of a path.
fn near(
    client: &mut Client,
    encoder: Encoder,
    (path, counts): (&[(u16, i64)], i64),
    (wanted_nm, wanted_counts): (f32, i64),
) -> RuleResult {
    let came_nm = at_the_end(client, encoder, path)?[1];
    let is_near = (came_nm - wanted_nm).abs() <= SAME_TORQUE * came_nm.abs().max(wanted_nm.abs());
    let expected = format!(
        "with the {} at {counts} counts {wanted_nm} N m to {} %, the torque at {wanted_counts} counts",
        encoder.name,
        100.0 * SAME_TORQUE,
    );
    expect(is_near, expected, format!("{came_nm} N m"))
}

/// The last two torques of a path. So far from zero one period at the speed limit still passes.
fn at_the_end(client: &mut Client, encoder: Encoder, path: &[(u16, i64)]) -> Result<[f32; 2], Failure> {
    client.reset()?;
    let setup = Setup::of(client, &FAST)?;
    setup.start(client)?;
    let mut torques_nm = [0.0; 2];
    let mut last = None;
    for &(sequence, counts) in path {
        let is_next = last.is_none_or(|last: u16| last.wrapping_add(1) == sequence);
        let flags = if is_next { NONE } else { TorqueFlags::GAP };
        let torque_nm = accepted(client, placed(encoder, sequence, counts), flags)?.torque_nm;
        torques_nm = [torques_nm[1], torque_nm];
        last = Some(sequence);
    }
    if let Some(&(sequence, counts)) = path.last() {
        let further = counts + setup.scale(encoder).most_counts(1);
        accepted(client, placed(encoder, sequence.wrapping_add(1), further), NONE)?;
    }
    Ok(torques_nm)
}
