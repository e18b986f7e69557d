//! Repeated samples: the same answer, and no control step.

use super::runs::{equal_torques, start_with_gaps, torques_of_a_run};
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R7.3", "a repeated sample gets the same torque, flagged REPEATED", |client| {
            client.running(&[])?;
            for sequence in 0..3 {
                let first = accepted(client, sample(sequence), NONE)?;
                (0..3).try_for_each(|_| repeated(client, sample(sequence), first))?;
                client.request(hello(client.session))?;
                repeated(client, sample(sequence), first)?;
            }
            Ok(())
        }),
        check(
            "R7.3 R7.4",
            "the answer to a repeated sample keeps GAP, and the next has no flag of it",
            |client| {
                let gap = start_with_gaps(client)?;
                first_sample(client)?;
                let first = accepted(client, sample(gap), TorqueFlags::GAP)?;
                (0..2).try_for_each(|_| repeated(client, sample(gap), first))?;
                accepted(client, sample(gap + 1), NONE).map(drop)
            },
        ),
        check("R7.3 R7.11", "the answer to a repeated sample keeps SATURATED", |client| {
            client.running_if_consistent(&[("torque_limit_nm", F32(0.0))])?;
            for sequence in 0..2 {
                let first = client.torque(sequence)?;
                repeated(client, sample(sequence), first)?;
            }
            Ok(())
        }),
        check("R7.3", "a repeated sample is recognised by its sequence alone", |client| {
            Setup::coarse(client)?.start(client)?;
            first_sample(client)?;
            let first = accepted(client, sample(1), NONE)?;
            let far = EncoderCounts::wrapping(1 << 20);
            let other =
                EncoderSample { sequence: 1, motor_counts: far, load_counts: far, reference_rad: f32::NAN };
            repeated(client, other, first)?;
            accepted(client, sample(2), NONE).map(drop)
        }),
        check("R7.3", "a repeated sample makes no control step", |client| {
            client.long_watchdog()?;
            let once = torques_of_a_run(client, |_, _| Ok(()))?;
            client.command(Stop {})?;
            let twice = torques_of_a_run(client, |client, sample| client.request_one(*sample).map(drop))?;
            equal_torques("with every sample repeated", &once, &twice)
        }),
    ]
}

/// Requires the answer `first` again, with `REPEATED`.
fn repeated(client: &mut Client, sample: EncoderSample, first: TorqueAnswer) -> RuleResult {
    let what = format!("to sample {} again", sample.sequence);
    let answers = of_kinds(&what, &["TorqueAnswer"], client.request_one(sample)?)?;
    let mut wanted = first;
    wanted.status.flags |= TorqueFlags::REPEATED;
    equal(&what, wanted, torque(&answers)?)
}
