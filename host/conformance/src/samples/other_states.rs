//! Samples outside `Running`.

use crate::prelude::checks::*;
use crate::reactions::no_torque_to;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R7.19", "a sample before the handshake is refused", |client| {
            for sequence in [0, 1] {
                let answers = of_kinds("answers", &["CommandResult"], client.sample(sequence)?)?;
                let got = (outcome::<EncoderSample>(&answers)?, client.state);
                equal("outcome and state", (WrongState, Boot), got)?;
            }
            Ok(())
        }),
        check("R7.19 R7.7 R8.4", "a sample before the start has no effect on the run", |client| {
            let setup = Setup::coarse(client)?;
            setup.start(client)?;
            let fresh = first_sample(client)?;
            for sequence in [1, 2] {
                accepted(client, sample(sequence), NONE)?;
            }
            client.command(Stop {})?;
            odd_samples(client, Idle)?;
            // The second time after a Stop that Faulted refuses, and a sample.
            for _ in 0..2 {
                let report = fault(&client.request(EmergencyStop {})?)?;
                equal("last sample accepted, in the report of an EmergencyStop", 2, report.sequence)?;
                client.request(Stop {})?;
                no_torque(client, 777, Faulted)?;
            }
            client.command(ClearFault {})?;
            client.arm()?;
            odd_samples(client, Armed)?;
            let report = fault(&client.request(EmergencyStop {})?)?;
            equal("last sample accepted, in the report of an EmergencyStop in Armed", 2, report.sequence)?;
            client.command(ClearFault {})?;
            client.arm()?;
            odd_samples(client, Armed)?;
            client.start()?;
            let first = accepted(client, sample(0), NONE)?;
            let same = fresh.torque_nm.to_bits() == first.torque_nm.to_bits();
            let expected = format!("the torque of the run before, {} N m", fresh.torque_nm);
            expect(same, expected, first.torque_nm)?;
            accepted(client, sample(1), NONE).map(drop)
        }),
    ];
    for state in [Idle, Armed, Faulted] {
        let name = format!("a sample gets torque zero in {state:?}");
        checks.push(check("R7.19 R6.1", name, move |client| {
            client.enter(state)?;
            odd_samples(client, state)
        }));
    }
    checks
}

/// Samples that would be a first one, a repetition, a next one with two jumps, a stray one and a fault in `Running`.
fn odd_samples(client: &mut Client, state: State) -> RuleResult {
    let far = EncoderCounts::wrapping(-(1 << 22));
    for (sequence, counts, reference_rad) in [
        (0, EncoderCounts::default(), 1.0),
        (0, EncoderCounts::default(), 1.0),
        (1, far, 1.0),
        (40_000, far, -1.0),
        (40_001, EncoderCounts::default(), f32::NAN),
        (u16::MAX, far, 0.0),
    ] {
        let odd = EncoderSample { sequence, motor_counts: counts, load_counts: counts, reference_rad };
        no_torque_to(client, odd, state)?;
        equal("state afterwards", state, client.state)?;
    }
    Ok(())
}
