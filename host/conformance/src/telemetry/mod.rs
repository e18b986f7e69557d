//! Telemetry: when it is sent and what keeps it (here), its values (`values`), and the subscriptions that a drive refuses
//! (`refusals`).

mod refusals;
pub(super) mod subscription;
mod values;

use crate::prelude::checks::*;
use subscription::{BOTH, TORQUE, accepted, carries, follows, lowest, running_with, signals};

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check(
            "R4.12 R11.2",
            "telemetry follows the torque of every sample whose sequence is a multiple of every",
            multiples,
        ),
        check("R11.2", "the interval of telemetry starts anew when the sequence wraps around", wraparound),
        check("R11.3", "no telemetry follows a repeated or a stray sample", |client| {
            let signals = signals(client)?;
            running_with(client, signals, 2)?;
            follows(client, 0, BOTH)?;
            follows(client, 0, TORQUE)?;
            follows(client, 1, TORQUE)?;
            follows(client, 2, BOTH)?;
            follows(client, 0, &["CommandResult"])?;
            follows(client, 3, TORQUE)?;
            follows(client, 4, BOTH)
        }),
        check("R11.3", "no telemetry follows the torque of a sample that causes a fault", |client| {
            let signals = signals(client)?;
            running_with(client, signals, 1)?;
            follows(client, 0, BOTH)?;
            let answers = client.request(EncoderSample { reference_rad: f32::NAN, ..sample(1) })?;
            fault_answer(&answers, FaultCode::ReferenceNotFinite).map(drop)?;
            follows(client, 2, TORQUE)
        }),
        check("R12.5", "a repeated Subscribe is accepted again", |client| {
            let signals = signals(client)?;
            client.long_watchdog()?;
            for step in [|_: &mut Client| Ok(()), Client::arm, Client::start] {
                step(client)?;
                (0..2).try_for_each(|_| accepted(client, signals, 3))?;
            }
            Ok(())
        }),
        check("R7.19 R11.2", "no telemetry follows a sample in another state than Running", |client| {
            let signals = signals(client)?;
            client.idle()?;
            accepted(client, signals, 1)?;
            follows(client, 0, TORQUE)?;
            client.arm()?;
            follows(client, 0, TORQUE)?;
            client.request(EmergencyStop {})?;
            follows(client, 0, TORQUE)
        }),
        check("R11.3", "every = 0 and no signal mean no telemetry", |client| {
            let all = signals(client)?;
            for (signals, every) in [(all, 0), (0, 1), (0, 0)] {
                client.reset()?;
                // Nothing of another subscription is left.
                client.idle()?;
                accepted(client, all, 1)?;
                running_with(client, signals, every)?;
                (0..4).try_for_each(|sequence| follows(client, sequence, TORQUE))?;
            }
            Ok(())
        }),
        check("R11.1", "after power-up there is no telemetry", |client| {
            client.running(&[])?;
            (0..4).try_for_each(|sequence| follows(client, sequence, TORQUE))
        }),
        check("R4.3 R6.8 R11.1", "a reset ends the subscription", |client| {
            let signals = signals(client)?;
            running_with(client, signals, 1)?;
            follows(client, 0, BOTH)?;
            client.reset()?;
            client.running(&[])?;
            (0..2).try_for_each(|sequence| follows(client, sequence, TORQUE))
        }),
        check("R6.8 R11.5", "a subscription outlives sessions, stops and faults", outlives),
        check("R7.19 R11.5 R11.8", "a subscription in Armed is that of the run", |client| {
            let signals = signals(client)?;
            client.armed()?;
            accepted(client, signals, 2)?;
            no_torque(client, 0, Armed)?;
            client.start()?;
            carries(client, 0, signals.count_ones())?;
            follows(client, 1, TORQUE)?;
            carries(client, 2, signals.count_ones())
        }),
        check("R11.2", "telemetry follows a limited torque too", |client| {
            let signals = signals(client)?;
            client.idle()?;
            accepted(client, signals, 1)?;
            client.running_if_consistent(&[(TORQUE_LIMIT_NM, F32(0.0))])?;
            (0..3).try_for_each(|sequence| carries(client, sequence, signals.count_ones()))
        }),
        check("R11.7", "a subscription while running replaces the former from the next sample", replaced),
    ];
    checks.extend(values::checks());
    checks.extend(refusals::checks());
    checks
}

/// Every sample of a run up to the 7th, then with gaps: not the count of samples matters, but the sequence.
fn multiples(client: &mut Client) -> RuleResult {
    let signals = signals(client)?;
    for (every, sequences) in [(1, 0..3), (3, 0..8), (u16::MAX, 0..3)] {
        client.reset()?;
        running_with(client, signals, every)?;
        for sequence in sequences {
            follows(client, sequence, if sequence % every == 0 { BOTH } else { TORQUE })?;
        }
    }
    let setup = Setup::coarse(client)?;
    let longest = setup.longest_gap();
    let with_gaps: [(u16, &[u16]); 6] = [
        (4, &[0, 2, 3, 5, 7, 8, 11, 12, 13]),
        // Of an interval of one byte these would be 0, 1, 44, 232 and 255.
        (256, &[0, 1, 255, 256, 257, 512]),
        (257, &[0, 1, 2, 256, 257, 258]),
        (300, &[0, 44, 88, 256, 299, 300, 301]),
        (1_000, &[0, 232, 464, 768, 1_000, 1_001]),
        (u16::MAX, &[0, 1, 255, 510, 1_020]),
    ];
    for (every, sequences) in with_gaps {
        let gaps = sequences.windows(2).map(|pair| pair[1] - pair[0]);
        if gaps.max().is_none_or(|gap| gap > longest) {
            continue;
        }
        client.reset()?;
        client.idle()?;
        accepted(client, signals, every)?;
        setup.start(client)?;
        for &sequence in sequences {
            follows(client, sequence, if sequence % every == 0 { BOTH } else { TORQUE })?;
        }
    }
    Ok(())
}

/// 65535 is a multiple of 5, and 0 follows it; 65531 is none.
fn wraparound(client: &mut Client) -> RuleResult {
    const FEWEST: u16 = 200;
    let signals = signals(client)?;
    let setup = Setup::coarse(client)?;
    let gap = setup.longest_gap();
    if gap < FEWEST {
        return skip(
            "not run: the encoders of this drive allow no long gaps, so the path takes too many samples",
        );
    }
    // The longest interval has its second multiple just before the wraparound.
    for every in [5, u16::MAX] {
        client.reset()?;
        client.idle()?;
        accepted(client, lowest(signals), every)?;
        setup.start(client)?;
        let gaps = (0..65_530).step_by(gap.into());
        for sequence in gaps.map(|it| it as u16).chain([65_530, 65_531, u16::MAX, 0, 1, 5]) {
            follows(client, sequence, if sequence % every == 0 { BOTH } else { TORQUE })?;
        }
    }
    Ok(())
}

fn outlives(client: &mut Client) -> RuleResult {
    let signals = signals(client)?;
    let count = signals.count_ones();
    let goes_on = |client: &mut Client| {
        carries(client, 0, count)?;
        follows(client, 1, TORQUE)?;
        carries(client, 2, count)
    };
    running_with(client, signals, 2)?;
    goes_on(client)?;
    client.request(Stop {})?;
    client.arm_and_start()?;
    goes_on(client)?;
    // A new session ends the run. `running` opens the session of this battery again, which is another one.
    client.request(hello(client.session ^ 1))?;
    client.request(other(client.session))?;
    client.running(&[])?;
    goes_on(client)?;
    client.request(EmergencyStop {})?;
    client.handshake(client.session ^ 1)?;
    client.request(ClearFault {})?;
    client.running(&[])?;
    goes_on(client)
}

fn replaced(client: &mut Client) -> RuleResult {
    let signals = signals(client)?;
    let count = signals.count_ones();
    client.running(&[])?;
    follows(client, 0, TORQUE)?;
    accepted(client, signals, 1)?;
    carries(client, 1, count)?;
    accepted(client, lowest(signals), 3)?;
    follows(client, 2, TORQUE)?;
    carries(client, 3, 1)?;
    accepted(client, 0, 1)?;
    follows(client, 4, TORQUE)?;
    accepted(client, signals, 0)?;
    follows(client, 5, TORQUE)?;
    equal("state", Running, client.state)
}
