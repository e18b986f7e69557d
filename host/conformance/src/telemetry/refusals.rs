//! Subscriptions that a drive refuses, in the order of its checks. None may change the subscription.

use lashloop_session::DriveSignal;

use super::super::exchanges::refused;
use super::super::pins::{has, widest_duties};
use super::subscription::{TORQUE, accepted, carries, follows, law_signals, lowest, signals};
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check(
            "R11.6 R11.8",
            "a signal that the drive does not have is refused and changes nothing",
            |client| {
                let unknown = unknown(client);
                if unknown == 0 {
                    return skip("the drive has all 32 signals");
                }
                let known = signals(client).map_or(0, lowest);
                // Each alone, with one that the drive has, and all 32, which are more than 13 too.
                let each = (0..32_u32).map(|index| 1 << index).filter(|bit| unknown & bit != 0);
                let refused: Vec<_> = each.chain([unknown, lowest(unknown) | known, u32::MAX]).collect();
                unchanged_by_refusals(client, known, &refused, UnknownIndex)
            },
        ),
        check("R11.6 R11.8", "more than 13 signals are refused as OutOfRange and change nothing", |client| {
            let count = u32::from(client.identity.signal_count);
            if count as usize <= MAX_TELEMETRY_VALUES {
                return skip("the drive has no 14 signals");
            }
            let known = signals(client).map_or(0, lowest);
            let too_many = (1 << (MAX_TELEMETRY_VALUES + 1)) - 1;
            unchanged_by_refusals(client, known, &[too_many, !unknown(client)], OutOfRange)
        }),
        check("R11.8", "13 signals are accepted", |client| {
            let all = (0..client.description.laws.len() as u8).map(|law| (law, law_signals(client, law)));
            let found = all.into_iter().find(|(_, signals)| signals.len() >= MAX_TELEMETRY_VALUES);
            let Some((law, of_law)) = found else { return skip("no law has 13 signals") };
            let last = &of_law[of_law.len() - MAX_TELEMETRY_VALUES..];
            let signals = last.iter().fold(0, |all, index| all | 1 << index);
            client.idle()?;
            client.put_law(law)?;
            accepted(client, signals, 1)?;
            client.running(&[])?;
            carries(client, 0, MAX_TELEMETRY_VALUES as u32)
        }),
        check("R6.4 R11.8", "Subscribe is refused for the state before all other reasons", |client| {
            client.in_states(&[Boot, Faulted], |client, state| {
                let masks = [0, 1, 1 << 31, u32::MAX, (1 << (MAX_TELEMETRY_VALUES + 1)) - 1];
                let refused = masks
                    .into_iter()
                    .map(|signals| result(Subscribe { signals, every: 1 }, WrongState, state));
                client.exchange(&format!("in {state:?}"), &refused.collect::<Vec<_>>())
            })
        }),
        check("R11.6", "a refused Subscribe in Boot and Faulted changes nothing", |client| {
            let known = signals(client)?;
            client.request(Subscribe { signals: known, every: 1 })?;
            client.running(&[])?;
            follows(client, 0, TORQUE)?;
            accepted(client, known, 1)?;
            client.request(EmergencyStop {})?;
            client.request(Subscribe { signals: 0, every: 0 })?;
            client.request(ClearFault {})?;
            client.running(&[])?;
            carries(client, 0, known.count_ones())
        }),
        check(
            "R6.6 R10.2 R11.8 R11.9 R11.10",
            "a signal that the law in force lacks is refused by Arm, and when armed",
            lacking,
        ),
    ]
}

/// The bits of no signal.
fn unknown(client: &Client) -> u32 {
    u32::MAX.checked_shl(client.identity.signal_count.into()).unwrap_or(0)
}

/// Subscribes to `known`, then to each of `refused`, and requires the telemetry of the first subscription: after refusals in
/// `Idle`, in `Armed` and in `Running`.
fn unchanged_by_refusals(client: &mut Client, known: u32, refused: &[u32], outcome: Outcome) -> RuleResult {
    client.idle()?;
    // Before the first subscription too.
    refusals(client, refused, outcome)?;
    accepted(client, known, 1)?;
    refusals(client, refused, outcome)?;
    client.running(&[])?;
    subscribed(client, 0, known)?;
    refusals(client, refused, outcome)?;
    subscribed(client, 1, known)?;
    client.request(Stop {})?;
    client.arm()?;
    refusals(client, refused, outcome)?;
    client.start()?;
    subscribed(client, 0, known)
}

/// Whether `every` is 0 or not.
fn refusals(client: &mut Client, refused: &[u32], outcome: Outcome) -> RuleResult {
    let state = client.state;
    let each = refused
        .iter()
        .flat_map(|&signals| [0, 7].map(|every| result(Subscribe { signals, every }, outcome, state)));
    let each: Vec<Exchange> = each.collect();
    client.exchange(&format!("in {state:?}"), &each)
}

/// Requires one value for each of these signals with the torque of a sample, and no telemetry for none.
fn subscribed(client: &mut Client, sequence: u16, signals: u32) -> RuleResult {
    match signals.count_ones() {
        0 => follows(client, sequence, TORQUE),
        count => carries(client, sequence, count),
    }
}

fn lacking(client: &mut Client) -> RuleResult {
    let laws = client.identity.law_count;
    let lacking = (0..laws).flat_map(|law| {
        let lacked = client.description.signals.iter().filter(move |it| !it.laws.contains(law));
        lacked.map(move |it| (law, it.clone()))
    });
    let lacking: Vec<(u8, DriveSignal)> = lacking.collect();
    // One that isn't the last of its subscription, if there is one.
    let is_before = |(law, it): &&(u8, DriveSignal)| law_signals(client, *law).last() > Some(&it.index);
    let Some((law, lacked)) = lacking.iter().find(is_before).or(lacking.first()).cloned() else {
        return skip("every law has every signal");
    };
    let other_law = (0..laws).find(|law| lacked.laws.contains(*law));
    let signals = 1 << lacked.index;
    let session = client.session;
    client.running(&[])?;
    client.request(Stop {})?;
    client.put_law(law)?;
    let watchdog = client.parameter(WATCHDOG_US)?.index;
    let kept = client.get(watchdog)?.value;
    // Beside a signal that the law has.
    let own = law_signals(client, law).last().map_or(0, |index| 1 << index);
    accepted(client, signals | own, 1)?;
    of_other_law(client, Arm { session }, Idle, &lacked)?;
    of_other_law_on_pins(client, &lacked)?;
    let before = line_report(&client.request(Stop {})?)?;
    for every in [0, 1] {
        accepted(client, signals, every)?;
        // Without telemetry Arm needs no signal.
        if every == 0 {
            client.arm()?;
            client.request(Stop {})?;
        } else {
            of_other_law(client, Arm { session }, Idle, &lacked)?;
        }
    }
    // The refusal lets the counts of the receiver continue, and keeps the values of parameters.
    let after = line_report(&client.request(Stop {})?)?;
    let went_on = after.messages > before.messages;
    expect(went_on, format!("more than {} messages after the refused Arm", before.messages), after.messages)?;
    client.exchange("after the refused Arm", &[reads(watchdog, kept, Idle)])?;
    // State and session come first.
    client.exchange("in Idle", &[result(Arm { session: session ^ 1 }, WrongSession, Idle)])?;
    // The refusal keeps the subscription, which another law has.
    if let Some(other_law) = other_law {
        client.put_law(other_law)?;
        client.running(&[])?;
        carries(client, 0, 1)?;
        client.request(Stop {})?;
        client.put_law(law)?;
    }
    client.request(EmergencyStop {})?;
    client.exchange("in Faulted", &[result(Arm { session }, WrongState, Faulted)])?;
    client.request(ClearFault {})?;
    let own = law_signals(client, law).first().map_or(0, |index| 1 << index);
    accepted(client, own, 3)?;
    client.arm()?;
    for every in [0, 1] {
        of_other_law(client, Subscribe { signals, every }, Armed, &lacked)?;
    }
    client.start()?;
    of_other_law(client, Subscribe { signals, every: 1 }, Running, &lacked)?;
    subscribed(client, 0, own)?;
    (1..3).try_for_each(|sequence| follows(client, sequence, TORQUE))?;
    client.exchange("in Running", &[result(Subscribe { signals: 0, every: 1 }, Accepted, Running)])
}

/// The same in bench mode, unless the pins are a reason too.
fn of_other_law_on_pins(client: &mut Client, lacked: &DriveSignal) -> RuleResult {
    if !has(client, Capabilities::BENCH_MODE) {
        return Ok(());
    }
    widest_duties(client)?;
    let answers = client.request(Arm { session: client.session })?;
    let it = command_result(&Arm::LAYOUT, &answers)?;
    if !matches!(it.outcome, EncoderImplausible | PowerStageFault) {
        let wanted = (SignalOfOtherLaw, u32::from(lacked.index));
        equal("to Arm in bench mode, outcome and detail", wanted, (it.outcome, it.detail))?;
    }
    client.put(SAMPLE_SOURCE, U32(0))
}

/// Requires the refusal with `SignalOfOtherLaw` in this state, with the index of the signal.
fn of_other_law<R: Payload + Into<HostMessage>>(
    client: &mut Client,
    request: R,
    state: State,
    lacked: &DriveSignal,
) -> RuleResult {
    let refusal = refused(request, SignalOfOtherLaw, state, lacked.index.into());
    client.exchange(&format!("in {state}"), &[refusal])
}
