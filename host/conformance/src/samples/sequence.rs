//! The sequence of samples: first, next, after a gap, stray.

use super::super::reactions::refused;
use super::runs::{equal_torques, start_with_gaps, torques_of_a_run};
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R7.2", "the first sample of a run must carry sequence 0", |client| {
            client.running(&[])?;
            let others = [1, 5, 1000, u16::MAX].into_iter().chain(1..8);
            others.into_iter().try_for_each(|sequence| refused_sample(client, sequence))?;
            for sequence in 0..3 {
                accepted(client, sample(sequence), NONE)?;
            }
            client.command(Stop {})?;
            client.arm_and_start()?;
            // The last sample of the run before, and the one after it.
            [2, 3, 1].into_iter().try_for_each(|sequence| refused_sample(client, sequence))?;
            [0, 1].into_iter().try_for_each(|sequence| accepted(client, sample(sequence), NONE).map(drop))
        }),
        check("R7.2 R7.4", "a gap is flagged GAP, once", |client| {
            let longest = start_with_gaps(client)?;
            first_sample(client)?;
            let mut last = 0;
            for gap in [1, longest, 1, 2, 1, 2, longest] {
                last += gap;
                let flags = if gap == 1 { NONE } else { TorqueFlags::GAP };
                accepted(client, sample(last), flags)?;
            }
            Ok(())
        }),
        check("R7.2 R7.4", "sequence 65535 wraps around to 0", wraparound),
        check("R7.2 R7.9", "a sample older than the last or far ahead of it is refused", |client| {
            let longest = start_with_gaps(client)?;
            for sequence in 0..3 {
                accepted(client, sample(sequence), NONE)?;
            }
            let last = 2_u16;
            let strays = [1, 2, 500, 1000, 1001, 1 << 15].map(|back| last.wrapping_sub(back));
            let ahead = [longest + 1, 1001, 2000, 1 << 15].map(|ahead| last + ahead);
            for sequence in strays.into_iter().chain(ahead) {
                refused_sample(client, sequence)?;
            }
            // A stray sample leaves no gap behind.
            accepted(client, sample(last + 1), NONE)?;
            accepted(client, sample(last + 1 + longest), TorqueFlags::GAP).map(drop)
        }),
        check("R7.6", "a refused sample makes no control step", |client| {
            client.long_watchdog()?;
            let quiet = torques_of_a_run(client, |_, _| Ok(()))?;
            client.command(Stop {})?;
            let disturbed = torques_of_a_run(client, |client, it| {
                // Half the sequence range ahead, displaced, and with faults of its own: a control step would change the
                // torque, a check of the encoders or of the reference would end the run.
                let far = EncoderCounts::wrapping(i64::from(it.load_counts.get()) + (1 << 20));
                let reference_rad = if it.sequence % 2 == 0 { f32::NAN } else { 7.0 };
                let sequence = it.sequence ^ 1 << 15;
                refused(
                    client,
                    EncoderSample { sequence, motor_counts: far, load_counts: far, reference_rad },
                )
            })?;
            equal_torques("with a refused sample after each", &quiet, &disturbed)
        }),
    ]
}

/// Twice through the wraparound: without and with a gap across it.
fn wraparound(client: &mut Client) -> RuleResult {
    let longest = Setup::coarse(client)?.longest_gap();
    start_with_gaps(client)?;
    first_sample(client)?;
    let mut last = 0;
    let mut advance_to = |client: &mut Client, target: u16| -> RuleResult {
        while last < target {
            let next = last.saturating_add(longest).min(target);
            let flags = if next == last + 1 { NONE } else { TorqueFlags::GAP };
            accepted(client, sample(next), flags)?;
            last = next;
        }
        last = 0;
        Ok(())
    };
    advance_to(client, u16::MAX)?;
    accepted(client, sample(0), NONE)?;
    accepted(client, sample(0), TorqueFlags::REPEATED)?;
    refused_sample(client, u16::MAX)?;
    advance_to(client, u16::MAX - 1)?;
    refused_sample(client, longest.wrapping_sub(1))?;
    let across = longest.wrapping_sub(2);
    accepted(client, sample(across), if longest == 1 { NONE } else { TorqueFlags::GAP })?;
    refused_sample(client, u16::MAX - 1)?;
    accepted(client, sample(across + 1), NONE).map(drop)
}
