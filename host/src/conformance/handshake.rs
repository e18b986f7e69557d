//! Handshake: identity, session and protocol version.

use lashloop_protocol::PROTOCOL_VERSION;
use lashloop_protocol::enums::{FaultCode, Outcome, State};
use lashloop_protocol::message::{Arm, Hello};

use super::answers::{fault, hello, identity, outcome};
use super::assertion::{RuleResult, equal, expect, names};
use super::check::{Check, check};
use super::client::Client;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R12", "Hello ends Boot", Client::idle),
        check("R12", "the identity has every field filled in", fields),
        check("R12", "the identity carries the session of its Hello", |client| {
            for session in [client.session, 0, u32::MAX] {
                equal("session", session, client.handshake(session)?.session)?;
            }
            Ok(())
        }),
        check("R12", "the same session again leaves a torque alone", |client| {
            client.running(&[])?;
            let before = client.torque(0)?.torque_nm;
            client.handshake(client.session)?;
            // The repeated sample returns the old torque without a step; the next one shows that the run continues.
            equal("repeated torque", before, client.torque(0)?.torque_nm)?;
            equal("state of the next torque", State::Running, client.torque(1)?.status.state)
        }),
        check("R12", "a new session keeps a latched fault and receives its report", |client| {
            client.faulted()?;
            let answers = client.request(hello(client.session ^ 1))?;
            equal("answers", vec!["Identity", "FaultReport"], names(&answers))?;
            equal("state", State::Faulted, identity(&answers)?.state)?;
            equal("fault", FaultCode::EmergencyStop, fault(&answers)?.code)
        }),
        check("R12", "another version is refused, and the identity carries the drive's own", other_version),
        check("R12", "a Hello of another version opens no session", |client| {
            let session = client.session;
            client.request(Hello { protocol_version: PROTOCOL_VERSION.wrapping_add(1), session })?;
            equal("Arm", (Outcome::WrongSession, State::Boot), client.command(Arm { session })?)
        }),
    ];
    for state in [State::Idle, State::Armed, State::Running, State::Faulted] {
        let name = format!("the same session again leaves {state:?}");
        checks.push(check("R12", name, move |client| {
            client.enter(state)?;
            equal("state", state, client.handshake(client.session)?.state)
        }));
    }
    for state in [State::Idle, State::Armed, State::Running] {
        let name = format!("a new session disarms from {state:?}");
        checks.push(check("R12", name, move |client| {
            client.enter(state)?;
            equal("state", State::Idle, client.handshake(client.session ^ 1)?.state)?;
            equal("state afterwards", State::Idle, client.state)
        }));
    }
    checks
}

fn fields(client: &mut Client) -> RuleResult {
    let it = client.handshake(client.session)?;
    equal("protocol version", PROTOCOL_VERSION, it.protocol_version)?;
    expect(!it.board.as_str().is_empty(), "the name of a board", it.board.as_str())?;
    expect(it.period_us > 0, "a control period", it.period_us)?;
    let counts = (it.motor_counts_per_rev, it.load_counts_per_rev);
    expect(counts.0 > 0 && counts.1 > 0, "counts per revolution of both encoders", counts)?;
    expect(it.law_count > 0, "at least one control law", it.law_count)?;
    expect(it.parameter_count > 0, "parameters", it.parameter_count)?;
    expect(it.dirty <= 1, "dirty of 0 or 1", it.dirty)
}

fn other_version(client: &mut Client) -> RuleResult {
    for protocol_version in [PROTOCOL_VERSION.wrapping_add(1), 0, u8::MAX] {
        let session = client.session;
        let answers = client.request(Hello { protocol_version, session })?;
        equal("answers", vec!["Identity", "CommandResult"], names(&answers))?;
        let it = identity(&answers)?;
        equal("version and session", (PROTOCOL_VERSION, session), (it.protocol_version, it.session))?;
        let what = format!("to Hello of version {protocol_version}");
        equal(&what, Outcome::VersionMismatch, outcome::<Hello>(&answers)?)?;
        equal("state", State::Boot, client.state)?;
    }
    Ok(())
}
