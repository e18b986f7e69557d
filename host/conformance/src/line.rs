//! The line report: what the drive's receiver counts, and since when.

use super::damage;
use super::receiver::{foreign, request};
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check(
            "R2.2 R4.15",
            "the LineReport of a clean run counts no damage, with idle delimiters",
            |client| {
                client.running(&[])?;
                client.send_bytes(&[DELIMITER; 5])?;
                client.torque(0)?;
                // The marker after Start, the sample, and Stop.
                reported(client, counted(3, 0, 0))
            },
        ),
        check("R2.7 R4.15", "the LineReport counts good, damaged and refused frames apart", |client| {
            client.running(&[])?;
            client.send_bytes(&damaged())?;
            client.send_bytes(&[request(0), request(1), request(2)].concat())?;
            reported(client, counted(5, 4, 2))
        }),
        check("R4.15", "every good frame counts as a message, of any outcome", outcomes),
        check("R4.15", "the LineReport counts each run from zero", |client| {
            client.running(&[])?;
            client.send_bytes(&damaged())?;
            client.request(Stop {})?;
            client.send_bytes(b"noise between runs\0")?;
            client.arm_and_start()?;
            reported(client, counted(2, 0, 0))
        }),
        check("R4.15 R6.3", "only a Start that is accepted restarts the counts", only_start),
        check("R4.3 R4.15", "Stop, sessions, faults and Reset let the counts continue", continued),
        check("R2.1 R3.1 R5.1", "every frame from the drive was a good message", |client| {
            let counters = *client.line.decoder.counters();
            client.note = format!("{} messages, {} of unknown kinds", counters.messages, counters.unknown);
            let got = (counters.damaged(), counters.refused);
            equal("damaged and refused frames of the drive", (0, 0), got)
        }),
    ]
}

/// Four damaged frames and two refused ones.
fn damaged() -> Vec<u8> {
    let stuffing = damage::stuffing(&request(0));
    let checksums = damage::checksums(&damage::body(&request(0)));
    let oversized = [&[0x55; 320][..], &[DELIMITER]].concat();
    let refused = foreign();
    [&stuffing[0], &checksums[0], &oversized, &vec![1, DELIMITER], &refused[0], &refused[refused.len() - 1]]
        .into_iter()
        .flatten()
        .copied()
        .collect()
}

fn reported(client: &mut Client, wanted: LineReport) -> RuleResult {
    equal("line report", wanted, report(client)?)
}

fn report(client: &mut Client) -> Result<LineReport, Failure> {
    line_report(&client.request(Stop {})?)
}

/// Samples of each kind, refused requests and a `Hello` of each kind, in one run.
fn outcomes(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    let session = client.session;
    let requests: [HostMessage; 8] = [
        sample(0).into(),
        sample(0).into(),
        sample(1 << 15).into(),
        hello(session).into(),
        other(session),
        Arm { session }.into(),
        Start { session: session ^ 1 }.into(),
        ClearFault {}.into(),
    ];
    for part in requests.chunks(4) {
        client.burst(part)?;
    }
    // The markers after Start and after both writes, the requests, and Stop.
    reported(client, counted(1 + 2 + 8 + 1, 0, 0))
}

fn only_start(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    let session = client.session;
    client.send_bytes(&damaged())?;
    let running = [Start { session }.into(), Start { session: session ^ 1 }.into(), Arm { session }.into()];
    client.burst(&running)?;
    // The markers after Start and after the requests, the requests, and Stop.
    reported(client, counted(1 + 4 + 1, 4, 2))?;
    // The marker after Stop, these requests with their marker, and Stop.
    client.burst(&[Start { session }.into(), Arm { session: session ^ 1 }.into(), Arm { session }.into()])?;
    reported(client, counted(6 + 1 + 4 + 1, 4, 2))
}

fn continued(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    let session = client.session;
    client.send_bytes(&damaged())?;
    let mut wanted = counted(2, 4, 2);
    reported(client, wanted)?;
    let ends: [(&str, Vec<HostMessage>); 7] = [
        ("Stop", Vec::new()),
        ("a Hello of the same session", vec![hello(session).into()]),
        ("a new session", vec![hello(session ^ 1).into()]),
        ("another session", vec![hello(session ^ 2).into()]),
        (
            "a new session in Faulted",
            vec![EmergencyStop {}.into(), hello(session ^ 4).into(), ClearFault {}.into()],
        ),
        ("Reset", vec![Reset {}.into()]),
        ("Hello and Arm after Reset", vec![hello(session).into(), Arm { session }.into()]),
    ];
    for (what, requests) in ends {
        client.send_bytes(&damaged())?;
        client.burst(&requests)?;
        // The marker of the last Stop, the requests and their marker, and the next Stop.
        wanted.messages += 1 + requests.len() as u32 + 1 + 1;
        wanted.damaged += 4;
        wanted.refused += 2;
        equal(&format!("after {what}, line report"), wanted, report(client)?)?;
    }
    Ok(())
}
