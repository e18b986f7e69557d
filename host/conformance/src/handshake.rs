//! Handshake: identity and protocol version.

use super::answers::of_version;
use super::sessions;
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R3.2 R4.4", "the identity has every field in its range", fields),
        check("R4.4 R6.7 R14.1", "the identity is the same in every state, and for every version", constant),
        check("R4.4 R9.14", "the identity carries the settings in force", settings),
        check(
            "R3.3 R4.4 R14.1 R14.2",
            "another version is refused, and the identity carries the drive's own",
            other_version,
        ),
        check("R6.7 R12.1 R14.2", "a Hello of another version opens no session", no_session),
    ];
    checks.extend(sessions::checks());
    checks
}

/// Those with a further bit too.
const OTHER_VERSIONS: [u8; 6] = [
    0,
    PROTOCOL_VERSION.wrapping_add(1),
    PROTOCOL_VERSION | 1 << 4,
    PROTOCOL_VERSION | 1 << 7,
    1 << 7,
    u8::MAX,
];

fn fields(client: &mut Client) -> RuleResult {
    let it = client.handshake(client.session)?;
    equal("protocol version", PROTOCOL_VERSION, it.protocol_version)?;
    expect((1..=16).contains(&it.law_count), "law_count of 1 to 16", it.law_count)?;
    expect(it.signal_count <= 32, "signal_count of 0 to 32", it.signal_count)?;
    expect(
        usize::from(it.parameter_count) <= MAX_PARAMETERS,
        "parameter_count of 0 to 240",
        it.parameter_count,
    )?;
    expect(it.dirty <= 1, "dirty of 0 or 1", it.dirty)
}

/// The fields that nothing changes.
fn fixed(it: Identity) -> Identity {
    Identity { session: 0, state: Boot, period_us: 0, motor_counts_per_rev: 0, load_counts_per_rev: 0, ..it }
}

fn constant(client: &mut Client) -> RuleResult {
    let wanted = fixed(client.identity);
    client.in_states(State::ALL, |client, state| {
        let session = client.session;
        for request in [other(session), hello(session).into(), hello(session ^ 1).into()] {
            let it = identity(&client.request(request)?)?;
            let what = format!("in {state:?} the Identity of the first handshake: {}", wanted.words());
            expect(fixed(it) == wanted, what, it)?;
        }
        Ok(())
    })
}

/// `Identity` holds whole numbers: the page leaves open how a fraction of an `F32` is rounded.
fn whole(value: ParameterValue) -> Option<u32> {
    match value {
        U32(value) => Some(value),
        F32(value) => (value.fract() == 0.0).then_some(value as u32),
        ParameterValue::Unknown { .. } => None,
    }
}

fn settings(client: &mut Client) -> RuleResult {
    // The defaults from `Boot` on, the largest, then two other settings, which differ from each other and between the encoders.
    in_identity(client, "after Reset")?;
    client.long_watchdog()?;
    for wished in [[u32::MAX; 3], [2_000, 4_096, 8_192], [3_000, 10_000, 5_000]] {
        put(client, wished)?;
        in_identity(client, "in Idle")?;
    }
    client.arm_if_consistent()?;
    in_identity(client, "in Armed")?;
    client.start()?;
    in_identity(client, "in Running")?;
    client.request(EmergencyStop {})?;
    in_identity(client, "in Faulted")?;
    client.reset()?;
    in_identity(client, "after another Reset")
}

const NAMES: [&str; 3] = ["period_us", "motor_counts_per_rev", "load_counts_per_rev"];

/// Sets period and counts per revolution of motor and load to the nearest numbers in range.
fn put(client: &mut Client, wished: [u32; 3]) -> RuleResult {
    for (name, wished) in NAMES.into_iter().zip(wished) {
        let value = nearest_whole(client.parameter(name)?, wished)?;
        client.put(name, U32(value))?;
    }
    Ok(())
}

/// Requires the parameters' values in the identity that a host of another version gets, which changes no state.
fn in_identity(client: &mut Client, when: &str) -> RuleResult {
    let it = identity(&client.request(other(client.session))?)?;
    let got = [it.period_us, it.motor_counts_per_rev, it.load_counts_per_rev];
    for (name, got) in NAMES.into_iter().zip(got) {
        let index = client.parameter(name)?.index;
        if let Some(wanted) = whole(client.get(index)?.value) {
            equal(&format!("{when}, {name} of the Identity"), wanted, got)?;
        }
    }
    Ok(())
}

fn no_session(client: &mut Client) -> RuleResult {
    let session = client.session;
    for protocol_version in OTHER_VERSIONS {
        client.reset()?;
        client.request(of_version(protocol_version, session))?;
        let when = format!("after a Hello of version {protocol_version}");
        client.exchange(&when, &[result(Arm { session }, WrongSession, Boot)])?;
        client.idle()?;
        client.burst(&[of_version(protocol_version, session ^ 1).into(); 2])?;
        let stale = result(Arm { session: session ^ 1 }, WrongSession, Idle);
        client.exchange(&when, &[stale, result(Arm { session }, Accepted, Armed)])?;
    }
    Ok(())
}

fn other_version(client: &mut Client) -> Result<(), Failure> {
    for protocol_version in OTHER_VERSIONS {
        for session in [client.session, 0, u32::MAX] {
            let answers = client.request(of_version(protocol_version, session))?;
            equal("answers", vec!["Identity", "CommandResult"], names(&answers))?;
            let it = identity(&answers)?;
            equal("version and session", (PROTOCOL_VERSION, session), (it.protocol_version, it.session))?;
            let what = format!("to Hello of version {protocol_version}");
            equal(&what, VersionMismatch, outcome::<Hello>(&answers)?)?;
            equal("state", Boot, client.state)?;
        }
    }
    Ok(())
}
