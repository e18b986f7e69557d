//! The first requests after a `Reset`, and runs and faults many times: a drive that errs only once, or only later, errs here.

use super::constancy::{COPIES, unknown_indices};
use super::receiver;
use super::telemetry::subscription::{law_signals, signals};
use crate::prelude::checks::*;

/// Resets in one write, each with a frame after it.
const RESETS: usize = 4;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check(
            "R4.1 R4.3 R6.2 R6.3",
            "the first request after a Reset is answered like any other",
            first_requests,
        ),
        check("R4.15 R7.2 R7.3 R7.17 R11.5", "every run of ten is like the first", runs),
        check(
            "R5.2 R8.1 R8.2 R8.3 R8.4",
            "every fault of ten is latched, reported and cleared like the first",
            faults,
        ),
    ]
}

/// Each as the first request and the first answer of its kind after a `Reset`.
fn first_requests(client: &mut Client) -> RuleResult {
    let session = client.session;
    let mut exchanges = unknown_indices(client, Boot);
    exchanges.extend([
        result(Subscribe { signals: 0, every: 0 }, WrongState, Boot),
        result(Arm { session }, WrongSession, Boot),
        result(Start { session }, WrongSession, Boot),
        result(sample(0), WrongState, Boot),
    ]);
    if let Some(it) = client.description.parameters.first() {
        exchanges.push(reads(it.index, it.default, Boot));
        exchanges.push(sets(it.index, it.max, WrongState, it.default, Boot));
    }
    for exchange in exchanges {
        client.exchange("right after Reset", &[result(Reset {}, Accepted, Boot), exchange])?;
    }
    for frames in [receiver::damaged(), receiver::foreign()].concat().chunks(RESETS) {
        let mut bytes = Vec::new();
        for frame in frames {
            bytes.extend([&*client.frame(Reset {}), frame].concat());
        }
        let what = "answers to a Reset before each of some frames that aren't requests";
        of_kinds(what, &vec!["CommandResult"; frames.len()], client.request_bytes(&bytes)?)?;
    }
    Ok(())
}

/// Runs of every law; the last one after a `Reset`.
fn runs(client: &mut Client) -> RuleResult {
    for law in client.description.laws.clone() {
        let mut first = None;
        let copies = client.repetitions(COPIES);
        for number in 1..=copies + 1 {
            // Nothing of a run survives a Reset either.
            if number == 1 || number > copies {
                client.reset()?;
                client.long_watchdog()?;
                client.put_law(law.index)?;
                let signals = signals_of(client, law.index);
                client.exchange("in Idle", &[result(Subscribe { signals, every: 2 }, Accepted, Idle)])?;
            }
            let mut answers = client.burst(&one_run(client.session))?;
            let what = format!("run {number} of {}", law.name);
            // All requests of the burst but `Arm` and `Start`.
            equal(&format!("messages in the report of {what}"), 7, line_report(&answers)?.messages)?;
            answers.iter_mut().for_each(forget_time);
            let first = first.get_or_insert_with(|| answers.clone());
            let differs = answers.iter().zip(&*first).find(|(answer, first)| answer != first);
            if let Some((answer, first)) = differs {
                return Err(broken(format!("in {what} {}", first.words()), answer.words()));
            }
            equal(&format!("answers in {what}"), first.len(), answers.len())?;
        }
    }
    Ok(())
}

/// Ends with both encoders one count away from the start, which is never a jump.
fn one_run(session: u32) -> [HostMessage; 9] {
    let [motor_counts, load_counts] = [1, -1].map(EncoderCounts::wrapping);
    let moved = |sequence| EncoderSample { motor_counts, load_counts, ..sample(sequence) };
    [
        Arm { session }.into(),
        Start { session }.into(),
        // Stray: the first is 0.
        sample(7).into(),
        sample(0).into(),
        EncoderSample { reference_rad: 0.5, ..sample(1) }.into(),
        moved(2).into(),
        moved(2).into(),
        moved(3).into(),
        Stop {}.into(),
    ]
}

fn signals_of(client: &Client, law: u8) -> u32 {
    law_signals(client, law).iter().take(MAX_TELEMETRY_VALUES).fold(0, |all, index| all | 1 << index)
}

fn faults(client: &mut Client) -> RuleResult {
    client.long_watchdog()?;
    let signals = signals(client).unwrap_or(0);
    client.exchange("in Idle", &[result(Subscribe { signals, every: 1 }, Accepted, Idle)])?;
    let with_telemetry = signals != 0;
    (1..=client.repetitions(COPIES) as u16).try_for_each(|number| one_fault(client, number, with_telemetry))
}

/// A run with 0 to 2 samples before its end, by `EmergencyStop` and by a reference in turn.
fn one_fault(client: &mut Client, number: u16, with_telemetry: bool) -> RuleResult {
    let session = client.session;
    let what = format!("fault {number}");
    let count = number % 3;
    let by_sample = number % 2 == 1;
    let mut requests = vec![Arm { session }.into(), Start { session }.into()];
    requests.extend((0..count).map(|sequence| HostMessage::from(sample(sequence))));
    requests.push(match by_sample {
        false => EmergencyStop {}.into(),
        true => EncoderSample { reference_rad: f32::NEG_INFINITY, ..sample(count) }.into(),
    });
    let (code, value) = match by_sample {
        false => (FaultCode::EmergencyStop, 0.0),
        true => (FaultCode::ReferenceNotFinite, f32::NEG_INFINITY),
    };
    let sequence = if by_sample { count } else { count.saturating_sub(1) };
    let wanted = latched(code, sequence, value);
    let mut kinds = vec!["CommandResult"; 2];
    let of_sample: &[_] = if with_telemetry { &["TorqueAnswer", "Telemetry"] } else { &["TorqueAnswer"] };
    kinds.extend(of_sample.repeat(usize::from(count)));
    kinds.extend(if by_sample { ["TorqueAnswer", "FaultReport"] } else { ["FaultReport", "CommandResult"] });
    let answers = of_kinds(&format!("{what}: answers"), &kinds, client.burst(&requests)?)?;
    equal(&what, wanted, fault(&answers)?)?;
    for it in answers.iter().filter_map(of::<TorqueAnswer>) {
        equal(&format!("{what}: flags"), NONE, it.status.flags - TorqueFlags::SATURATED)?;
    }
    equal(&format!("{what}: state"), Faulted, client.state)?;
    let own = latched(FaultCode::EmergencyStop, sequence, 0.0);
    equal(&format!("{what}, then EmergencyStop"), own, fault(&client.request(EmergencyStop {})?)?)?;
    let answers = client.request(hello(session))?;
    equal(&format!("{what}: state of the Identity"), Faulted, identity(&answers)?.state)?;
    equal(&format!("{what}: after the Identity"), wanted, fault(&answers)?)?;
    let answer = torque(&client.sample(count)?)?;
    let got = (answer.torque_nm, answer.status.state);
    equal(&format!("{what}: torque and state of a sample"), (0.0, Faulted), got)?;
    client.exchange(&what, &[result(ClearFault {}, Accepted, Idle)])?;
    let answers = client.request(hello(session))?;
    equal(&format!("{what}: after ClearFault, answers to Hello"), vec!["Identity"], names(&answers))
}
