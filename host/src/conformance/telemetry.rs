//! Telemetry: the signals that the host subscribed to.

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::limits::MAX_TELEMETRY_VALUES;
use lashloop_protocol::message::{Arm, ClearFault, Reset, Stop, Subscribe};
use lashloop_protocol::wire::Payload;
use lashloop_protocol::{DriveMessage, HostMessage, Message};

use lashloop_bench::session::DriveSignal;

use super::answers::{outcome, telemetry, torque};
use super::assertion::{Failure, RuleResult, equal, expect, names, skip};
use super::check::{Check, check};
use super::client::{CONTROLLER, Client};

/// Samples of the checks of values.
const STEPS: u16 = 5;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R11", "telemetry follows the torque of every n-th sample", |client| {
            let signals = signals(client)?;
            running_with(client, signals, 3)?;
            for sequence in 0..7_u16 {
                let answers = client.sample(sequence)?;
                let both = vec!["TorqueAnswer", "Telemetry"];
                let wanted = if sequence.is_multiple_of(3) { both } else { vec!["TorqueAnswer"] };
                equal(&format!("to sample {sequence} with every = 3"), wanted, names(&answers))?;
                if sequence.is_multiple_of(3) {
                    equal("sequence of the telemetry", sequence, telemetry(&answers)?.sequence)?;
                }
            }
            Ok(())
        }),
        check("R11", "no telemetry follows a repeated sample", |client| {
            let signals = signals(client)?;
            running_with(client, signals, 1)?;
            client.sample(0)?;
            equal("answers", vec!["TorqueAnswer"], names(&client.sample(0)?))
        }),
        check("R11", "every = 0 and no signal mean no telemetry", |client| {
            for (signals, every) in [(signals(client)?, 0), (0, 1)] {
                client.reset()?;
                running_with(client, signals, every)?;
                for sequence in 0..5 {
                    equal("answers", vec!["TorqueAnswer"], names(&client.sample(sequence)?))?;
                }
            }
            Ok(())
        }),
        check("R11", "after power-up there is no telemetry", |client| {
            client.running(&[])?;
            (0..20).try_for_each(|sequence| {
                equal("answers", vec!["TorqueAnswer"], names(&client.sample(sequence)?))
            })
        }),
        check("R11", "a reset ends the subscription", |client| {
            let signals = signals(client)?;
            running_with(client, signals, 1)?;
            client.command(Reset {})?;
            client.running(&[])?;
            equal("answers", vec!["TorqueAnswer"], names(&client.sample(0)?))
        }),
        check("R11", "a subscription outlives sessions, stops and faults", outlives),
        check("R11", "a subscription while running takes effect from the next sample", |client| {
            let signals = signals(client)?;
            client.running(&[])?;
            client.sample(0)?;
            accepted(client, signals, 1)?;
            equal("answers", vec!["TorqueAnswer", "Telemetry"], names(&client.sample(1)?))
        }),
        check(
            "R11",
            "values are those of the subscribed signals, in the order of their indices",
            order_of_values,
        ),
        check("R11", "a signal that the drive does not have is refused and changes nothing", |client| {
            let count = u32::from(client.identity.signal_count);
            let Some(unknown) = 1_u32.checked_shl(count) else { return skip("the drive has all 32 signals") };
            let known = signals(client).map_or(0, lowest);
            unchanged_by_refusals(
                client,
                known,
                &[unknown, unknown | known, 1 << 31 | unknown],
                Outcome::UnknownIndex,
            )
        }),
        check("R11", "more than 13 signals are refused as OutOfRange and change nothing", |client| {
            let count = u32::from(client.identity.signal_count);
            if count as usize <= MAX_TELEMETRY_VALUES {
                return skip("the drive has no 14 signals");
            }
            let known = signals(client).map_or(0, lowest);
            let too_many = (1 << (MAX_TELEMETRY_VALUES + 1)) - 1;
            unchanged_by_refusals(client, known, &[too_many], Outcome::OutOfRange)
        }),
        check("R11", "a signal that the law in force lacks is refused by Arm, and when armed", lacking),
        check("R11", "telemetry carries the requested torque before the limit", |client| {
            let index = client.description.signals.iter().find(|it| it.signal.name == "requested_torque_nm");
            let Some(index) = index.map(|it| it.index) else {
                return skip("the drive has no signal requested_torque_nm");
            };
            running_with(client, 1 << index, 1)?;
            let limit_nm = client.real("torque_limit_nm")?;
            (0..3).try_for_each(|sequence| {
                let answers = client.sample(sequence)?;
                let wanted_nm = telemetry(&answers)?.values.as_slice()[0].clamp(-limit_nm, limit_nm);
                let what = "torque, of that in the telemetry within the limit,";
                equal(what, wanted_nm, torque(&answers)?.torque_nm)
            })
        }),
    ];
    for state in [State::Boot, State::Faulted] {
        checks.push(check("R11", format!("Subscribe is refused in {state:?}"), move |client| {
            client.enter(state)?;
            let got = client.command(Subscribe { signals: 0, every: 0 })?;
            equal("outcome and state", (Outcome::WrongState, state), got)
        }));
    }
    for state in [State::Idle, State::Armed, State::Running] {
        checks.push(check("R11", format!("Subscribe is accepted in {state:?}"), move |client| {
            client.enter(state)?;
            let signals = signals(client).unwrap_or(0);
            let got = client.command(Subscribe { signals, every: 1 })?;
            equal("outcome and state", (Outcome::Accepted, state), got)
        }));
    }
    checks
}

/// The signals of the law in force, 13 at most.
///
/// # Errors
/// The law has none: the check is skipped.
fn signals(client: &Client) -> Result<u32, Failure> {
    let bits = law_signals(client, client.default_law());
    match bits.first() {
        None => skip("the law in force has no signal").map(|()| 0),
        Some(_) => Ok(bits.iter().take(MAX_TELEMETRY_VALUES).fold(0, |all, index| all | 1 << index)),
    }
}

/// The indices of the signals of a law.
fn law_signals(client: &Client, law: u8) -> Vec<u8> {
    let of_law = client.description.signals.iter().filter(|it| it.laws.contains(law));
    of_law.map(|it| it.index).collect()
}

fn accepted(client: &mut Client, signals: u32, every: u16) -> RuleResult {
    let (outcome, _) = client.command(Subscribe { signals, every })?;
    equal(&format!("to signals {signals:#x}"), Outcome::Accepted, outcome)
}

/// The signal of a subscription with the lowest index, alone.
const fn lowest(signals: u32) -> u32 {
    signals & signals.wrapping_neg()
}

/// Subscribes to `known`, then to each of `refused`, and requires the telemetry of the first subscription: after refusals in
/// `Idle` and after refusals in `Running`.
fn unchanged_by_refusals(client: &mut Client, known: u32, refused: &[u32], outcome: Outcome) -> RuleResult {
    client.idle()?;
    accepted(client, known, 1)?;
    refusals(client, refused, outcome)?;
    client.running(&[])?;
    subscribed(client, 0, known)?;
    refusals(client, refused, outcome)?;
    subscribed(client, 1, known)
}

fn refusals(client: &mut Client, refused: &[u32], wanted: Outcome) -> RuleResult {
    for &signals in refused {
        for every in [0, 1] {
            let (outcome, _) = client.command(Subscribe { signals, every })?;
            equal(&format!("to signals {signals:#x}, every {every}"), wanted, outcome)?;
        }
    }
    Ok(())
}

/// Requires one value for each of these signals with the torque of a sample, and no telemetry for none.
fn subscribed(client: &mut Client, sequence: u16, signals: u32) -> RuleResult {
    let answers = client.sample(sequence)?;
    let both = vec!["TorqueAnswer", "Telemetry"];
    let wanted = if signals == 0 { vec!["TorqueAnswer"] } else { both };
    equal(&format!("to sample {sequence} after the refusals"), wanted, names(&answers))?;
    if signals == 0 {
        return Ok(());
    }
    let values = telemetry(&answers)?.values.as_slice().len();
    equal("values of the telemetry after the refusals", signals.count_ones() as usize, values)
}

fn running_with(client: &mut Client, signals: u32, every: u16) -> RuleResult {
    client.idle()?;
    accepted(client, signals, every)?;
    client.running(&[])
}

fn outlives(client: &mut Client) -> RuleResult {
    let signals = signals(client)?;
    running_with(client, signals, 1)?;
    client.command(Stop {})?;
    client.handshake(client.session ^ 1)?;
    client.faulted()?;
    client.command(ClearFault {})?;
    client.running(&[])?;
    equal("answers", vec!["TorqueAnswer", "Telemetry"], names(&client.sample(0)?))
}

/// Each signal alone and all together, on the same samples.
fn order_of_values(client: &mut Client) -> RuleResult {
    let all = signals(client)?;
    let indices: Vec<_> = (0..32_u8).filter(|index| all & 1 << index != 0).collect();
    let mut alone = Vec::new();
    for index in &indices {
        alone.push(series(client, 1 << index)?);
    }
    let together = series(client, all)?;
    for step in 0..usize::from(STEPS) {
        let wanted: Vec<_> = alone.iter().flat_map(|series| series[step].clone()).collect();
        equal(&format!("values of sample {step}, as bits,"), wanted, together[step].clone())?;
    }
    Ok(())
}

/// The values of a run's telemetry as bits, one list a sample.
fn series(client: &mut Client, signals: u32) -> Result<Vec<Vec<u32>>, Failure> {
    client.reset()?;
    running_with(client, signals, 1)?;
    (0..STEPS)
        .map(|sequence| {
            let telemetry = telemetry(&client.sample(sequence)?)?;
            let values: Vec<_> = telemetry.values.as_slice().iter().map(|value| value.to_bits()).collect();
            equal("number of values", signals.count_ones() as usize, values.len())?;
            Ok(values)
        })
        .collect()
}

fn lacking(client: &mut Client) -> RuleResult {
    let laws = client.identity.law_count;
    let lacks = |law: u8, it: &&DriveSignal| !it.laws.contains(law);
    let found = (0..laws).find_map(|law| {
        client.description.signals.iter().find(|it| lacks(law, it)).map(|it| (law, it.clone()))
    });
    let Some((law, lacked)) = found else { return skip("every law has every signal") };
    client.idle()?;
    client.put(CONTROLLER, ParameterValue::U32(law.into()))?;
    accepted(client, 1 << lacked.index, 1)?;
    let session = client.session;
    inconsistent(client, Arm { session }, State::Idle, &lacked)?;
    accepted(client, 0, 0)?;
    client.arm()?;
    let subscribe = Subscribe { signals: 1 << lacked.index, every: 1 };
    inconsistent(client, subscribe, State::Armed, &lacked)?;
    client.start()?;
    inconsistent(client, subscribe, State::Running, &lacked)
}

/// Requires the refusal with `Inconsistent` in this state, after a `Log` that names the signal.
fn inconsistent<R: Payload + Into<HostMessage>>(
    client: &mut Client,
    request: R,
    state: State,
    lacked: &DriveSignal,
) -> RuleResult {
    let answers = client.request_with_logs(&request.into().frame())?;
    let what = format!("{} in {state:?}", R::LAYOUT.name);
    equal(&what, (Outcome::Inconsistent, state), (outcome::<R>(&answers)?, client.state))?;
    // A log may take several lines.
    let before = answers.iter().take_while(|answer| !matches!(answer, DriveMessage::CommandResult(_)));
    let log: String = before
        .filter_map(|answer| match answer {
            DriveMessage::Log(it) => Some(it.text.as_str()),
            _ => None,
        })
        .collect();
    let name = &*lacked.signal.name;
    expect(log.contains(name), format!("{what}: before the refusal a Log that names {name}"), log)
}
