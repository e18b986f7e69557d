//! Sessions: whose `Arm` and `Start` a drive accepts, and what a session begins, ends and keeps.

use super::states::LONG_WATCHDOG_US;
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R3.1 R4.4 R12.1", "every number is a session, and the identity carries it", every_number),
        check("R12.1", "Arm and Start of a session that differs in one bit are refused", one_bit),
        check("R6.5", "before the first Hello no number is a session", |client| {
            let session = client.session;
            for number in [0, session, u32::MAX] {
                let arm = result(Arm { session: number }, WrongSession, Boot);
                let start = result(Start { session: number }, WrongSession, Boot);
                client.exchange("after Reset", &[arm, start])?;
            }
            Ok(())
        }),
        check("R12.1 R12.2", "a new session makes the previous one stale in every state", previous),
        check("R4.3 R12.4", "Reset ends the session", |client| {
            let session = client.session;
            client.idle()?;
            client.exchange("in Idle", &[result(Reset {}, Accepted, Boot)])?;
            client.exchange("after Reset", &[result(Arm { session }, WrongSession, Boot)])?;
            client.handshake(session ^ 1)?;
            client.exchange("in a new session", &[result(Arm { session }, WrongSession, Idle)])
        }),
        check("R12.4", "Stop, faults and ClearFault keep the session", kept),
        check("R12.2", "a new session ends a run without a message", |client| {
            client.running(&[])?;
            client.torque(0)?;
            let answers = client.request(hello(client.session ^ 1 << 31))?;
            let answers = of_kinds("answers", &["Identity"], answers)?;
            equal("state", Idle, identity(&answers)?.state)?;
            no_torque(client, 1, Idle)
        }),
        check("R6.5 R6.7", "a fault cleared before the handshake leads back to Boot", before_handshake),
        check(
            "R4.13 R8.2 R8.3 R8.4",
            "the report of a latched fault follows every Identity, unchanged",
            report_of_latched,
        ),
        check(
            "R6.3 R6.7 R12.3 R12.5",
            "a request that changes nothing leaves the torques of a run alone",
            undisturbed,
        ),
    ]
}

fn every_number(client: &mut Client) -> RuleResult {
    for session in [0, 1, 1 << 31, u32::MAX, 0x0102_0304] {
        client.reset()?;
        let it = client.handshake(session)?;
        equal("session and state", (session, Idle), (it.session, it.state))?;
        client.put(WATCHDOG_US, U32(LONG_WATCHDOG_US))?;
        let armed = result(Arm { session }, Accepted, Armed);
        let running = result(Start { session }, Accepted, Running);
        client.exchange(&format!("in session {session}"), &[armed, running])?;
        client.command(EmergencyStop {})?;
        let cleared = client.command(ClearFault {})?;
        equal(&format!("ClearFault in session {session}"), (Accepted, Idle), cleared)?;
    }
    Ok(())
}

fn one_bit(client: &mut Client) -> RuleResult {
    let session = client.session;
    let bits = move || (0..u32::BITS).map(move |bit| session ^ 1 << bit);
    let others = || bits().chain([0, u32::MAX]).filter(|other| *other != session);
    client.long_watchdog()?;
    let arms: Vec<_> = others().map(|session| result(Arm { session }, WrongSession, Idle)).collect();
    client.exchange("in Idle", &arms)?;
    client.arm()?;
    let starts: Vec<_> = others().map(|session| result(Start { session }, WrongSession, Armed)).collect();
    client.exchange("in Armed", &starts)?;
    client.start()
}

fn previous(client: &mut Client) -> RuleResult {
    let session = client.session;
    let new = session ^ 1 << 24;
    for state in [Idle, Armed, Running, Faulted] {
        client.reset()?;
        client.long_watchdog()?;
        client.enter(state)?;
        let after = client.handshake(new)?.state;
        let stale =
            [result(Arm { session }, WrongSession, after), result(Start { session }, WrongSession, after)];
        let when = format!("after a new session in {state:?}");
        client.exchange(&when, &stale)?;
        if state == Faulted {
            client.exchange(&when, &[result(ClearFault {}, Accepted, Idle)])?;
            client.exchange(&when, &[result(Arm { session }, WrongSession, Idle)])?;
        }
        client.exchange(&when, &[result(Arm { session: new }, Accepted, Armed)])?;
        client.exchange(&when, &[result(Start { session }, WrongSession, Armed)])?;
        client.exchange(&when, &[result(Start { session: new }, Accepted, Running)])?;
    }
    Ok(())
}

fn kept(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    let session = client.session;
    let [arm, start] =
        [result(Arm { session }, Accepted, Armed), result(Start { session }, Accepted, Running)];
    client.request(Stop {})?;
    client.exchange("after Stop", &[arm, start])?;
    client.request(EmergencyStop {})?;
    client.exchange("after EmergencyStop", &[result(ClearFault {}, Accepted, Idle), arm, start])?;
    client.request(EncoderSample { reference_rad: f32::INFINITY, ..sample(0) })?;
    client.exchange("after a fault", &[result(ClearFault {}, Accepted, Idle), arm, start])
}

fn before_handshake(client: &mut Client) -> RuleResult {
    let session = client.session;
    let cleared = result(ClearFault {}, Accepted, Boot);
    client.request(EmergencyStop {})?;
    client.exchange("without a session", &[result(Arm { session }, WrongSession, Faulted), cleared])?;
    // A host of another version opens no session either.
    client.request(EmergencyStop {})?;
    client.request(other(session))?;
    client.exchange("after a Hello of another version", &[cleared])?;
    client.request(EmergencyStop {})?;
    equal("state of the Identity", Faulted, client.handshake(session)?.state)?;
    client.exchange("after a Hello in Faulted", &[result(ClearFault {}, Accepted, Idle)])
}

fn report_of_latched(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    client.torque(0)?;
    client.torque(1)?;
    let answers = client.request(EncoderSample { reference_rad: f32::NEG_INFINITY, ..sample(2) })?;
    let wanted = fault(&answers)?;
    equal("code and sequence", (FaultCode::ReferenceNotFinite, 2), (wanted.code, wanted.sequence))?;
    let own = latched(FaultCode::EmergencyStop, 2, 0.0);
    equal("report of an EmergencyStop in Faulted", own, fault(&client.request(EmergencyStop {})?)?)?;
    client.request(Stop {})?;
    client.sample(3)?;
    let session = client.session;
    let with_result = ["Identity", "FaultReport", "CommandResult"];
    let without = &with_result[..2];
    let hellos: [(HostMessage, &[_]); 5] = [
        (hello(session).into(), without),
        (other(session), &with_result),
        (hello(session ^ 1).into(), without),
        (hello(session ^ 2).into(), without),
        (hello(session ^ 2).into(), without),
    ];
    for (request, kinds) in hellos {
        let answers = of_kinds("answers", kinds, client.request(request)?)?;
        equal("state", Faulted, identity(&answers)?.state)?;
        equal("after the Identity", wanted, fault(&answers)?)?;
    }
    equal("ClearFault", (Accepted, Idle), client.command(ClearFault {})?)?;
    equal("answers to a Hello after it", vec!["Identity"], names(&client.request(hello(session))?))
}

/// Requests between two samples of a run, none of which changes anything.
fn idle_requests(client: &Client) -> Vec<HostMessage> {
    let session = client.session;
    let mut requests: Vec<HostMessage> = vec![
        hello(session).into(),
        other(session ^ 1),
        Arm { session }.into(),
        Arm { session: session ^ 1 }.into(),
        Start { session }.into(),
        Start { session: session ^ 1 }.into(),
        ClearFault {}.into(),
        DescribeLaw { index: 0 }.into(),
        DescribeSignal { index: 0 }.into(),
        DescribeParameter { index: 0 }.into(),
        DescribeChoice { parameter: 0, choice: 0 }.into(),
        GetParameter { index: 0 }.into(),
        Subscribe { signals: 0, every: 0 }.into(),
    ];
    let fixed = client.description.parameters.iter().filter(|it| !it.live);
    requests
        .extend(fixed.take(3).map(|it| HostMessage::from(SetParameter { index: it.index, value: it.max })));
    requests
}

/// The torques of a run as bits, with these requests between the samples.
fn torques(client: &mut Client, between: &[HostMessage], count: u16) -> Result<Vec<u32>, Failure> {
    client.reset()?;
    client.running(&[])?;
    let mut torques = Vec::new();
    for sequence in 0..count {
        // The mechanics stay at rest: a coarse encoder would exceed its speed limit.
        let reference_rad = 1.0 + 0.125 * f32::from(sequence);
        let sample = EncoderSample { reference_rad, ..sample(sequence) };
        let answer = torque(&client.request(sample)?)?;
        equal(&format!("state of sample {sequence}"), Running, answer.status.state)?;
        torques.push(answer.torque_nm.to_bits());
        if let Some(request) = between.get(usize::from(sequence)) {
            client.request(*request)?;
            equal("state after a request that changes nothing", Running, client.state)?;
        }
    }
    Ok(torques)
}

fn undisturbed(client: &mut Client) -> RuleResult {
    let requests = idle_requests(client);
    let count = requests.len() as u16 + 1;
    let wanted = torques(client, &[], count)?;
    let got = torques(client, &requests, count)?;
    let changed = wanted.iter().zip(&got).position(|(wanted, got)| wanted != got);
    let what = "sample whose torque differs after a request that changes nothing";
    equal(what, None, changed)
}
