//! The torque limit, and the end of the torque with the run.

use crate::prelude::checks::*;
use crate::telemetry::subscription::accepted;

const LIMIT: &str = "torque_limit_nm";
/// References of one sign and of the other, in rad.
const REFERENCES: [f32; 2] = [1.0, -1.0];
/// References whose torques have different digits, and how many of them show a rule.
const KNOWN_REFERENCES: [f32; 10] = [1.0, -0.9, 0.77, -0.61, 0.53, -0.43, 0.37, -0.29, 0.23, -0.19];
const FEWEST_KNOWN: usize = 8;
const KEEPS_WITHIN: &str =
    "not judged: the law in force keeps within the limit by itself, as requested_torque_nm shows";
/// Samples of a run, and runs, at the limit.
const SAMPLES: u16 = 10;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R7.11 R10.14", "a torque beyond the limit is limited and flagged SATURATED", limited),
        check("R7.4 R7.11", "a limited torque after a gap is flagged GAP and SATURATED", limited_after_gap),
        check("R7.11", "a torque of exactly the limit is not flagged SATURATED", at_the_limit),
        check("R7.11 R9.6", "the torque limit of each run is the one set before its Arm", limits_of_runs),
        check("R7.11 R7.12", "an extreme reference gives a torque at the limit at most, or a fault", extreme),
    ];
    checks.extend(ends_of_torque());
    checks
}

/// The first torque of a run with this limit, for this reference.
fn first_torque(
    client: &mut Client,
    limit: ParameterValue,
    reference_rad: f32,
) -> Result<TorqueAnswer, Failure> {
    client.reset()?;
    client.running_if_consistent(&[(LIMIT, limit)])?;
    torque(&client.request_one(EncoderSample { reference_rad, ..sample(0) })?)
}

/// Whether the law in force keeps within this limit by itself, as `requested_torque_nm` of its first sample shows. A drive without that
/// signal can't show it.
fn keeps_within(client: &mut Client, limit_nm: f32, reference_rad: f32) -> Result<bool, Failure> {
    let Some(signal) = client.requested_torque() else { return Ok(false) };
    client.reset()?;
    client.idle()?;
    accepted(client, 1 << signal, 1)?;
    client.running_if_consistent(&[(LIMIT, F32(limit_nm))])?;
    let answers = client.request(EncoderSample { reference_rad, ..sample(0) })?;
    let it = torque(&answers)?;
    let is_requested = telemetry(&answers)?.values.as_slice() == [it.torque_nm];
    Ok(is_requested && it.torque_nm.abs() <= limit_nm && it.status.flags == NONE)
}

fn limited(client: &mut Client) -> RuleResult {
    let highest = client.parameter(LIMIT)?.max;
    for reference_rad in REFERENCES {
        let free = first_torque(client, highest, reference_rad)?;
        let free_nm = free.torque_nm;
        // A law need not push in this direction.
        if free_nm == 0.0 {
            continue;
        }
        let what = format!("reference {reference_rad} rad");
        if free.status.flags == TorqueFlags::SATURATED {
            equal(&format!("{what}: SATURATED at {LIMIT}"), highest, F32(free_nm.abs()))?;
        } else {
            equal(&format!("{what}: far from the limit"), NONE, free.status.flags)?;
            let above_nm = free_nm.abs().next_up();
            let same = first_torque(client, F32(above_nm), reference_rad)?;
            let is_free = same.status.flags.is_empty() && same.torque_nm.abs() <= free_nm.abs();
            let expected = format!("{what}, limit {above_nm} N m: {free_nm} N m, no flags");
            expect(is_free, expected, same)?;
        }
        for limit_nm in
            [0.995 * free_nm.abs(), free_nm.abs() / 2.0, free_nm.abs() / 16.0, 1e-5 * free_nm.abs(), 0.0]
        {
            let answer = first_torque(client, F32(limit_nm), reference_rad)?;
            let wanted = (limit_nm.copysign(free_nm), Running, TorqueFlags::SATURATED);
            let got = (answer.torque_nm, answer.status.state, answer.status.flags);
            if got != wanted && keeps_within(client, limit_nm, reference_rad)? {
                continue;
            }
            equal(&format!("{what}, limit {limit_nm} N m: torque in N m, state and flags"), wanted, got)?;
            // The flag ends with the limitation.
            let next = torque(&client.request_one(EncoderSample { reference_rad: 0.0, ..sample(1) })?)?;
            let is_saturated = next.status.flags == TorqueFlags::SATURATED;
            let expected = format!("at {limit_nm} N m, and at no smaller torque, SATURATED");
            expect(!is_saturated || next.torque_nm.abs() == limit_nm, expected, next)?;
        }
    }
    // A torque of zero is not clamped by a limit of zero.
    let free = first_torque(client, highest, 0.0)?;
    if free.torque_nm == 0.0 {
        let it = first_torque(client, F32(0.0), 0.0)?;
        let got = (it.torque_nm, it.status.state, it.status.flags);
        let wanted = (0.0, Running, NONE);
        equal("reference 0 rad, limit 0 N m: torque in N m, state and flags", wanted, got)?;
    }
    Ok(())
}

fn limited_after_gap(client: &mut Client) -> RuleResult {
    let setup = Setup::coarse(client)?;
    if setup.longest_gap() < 2 {
        return skip("not run: no encoder setting of this drive allows a gap");
    }
    let after_gap = |client: &mut Client, limit: ParameterValue| {
        client.reset()?;
        setup.allowed(client)?;
        client.running_if_consistent(&[&setup.settings()[..], &[(LIMIT, limit)]].concat())?;
        client.torque(0)?;
        client.torque(2)
    };
    let highest = client.parameter(LIMIT)?.max;
    let free_nm = after_gap(client, highest)?.torque_nm;
    let limit_nm = free_nm.abs() / 16.0;
    if limit_nm == 0.0 {
        return skip("not run: the law in force requests no torque");
    }
    let it = after_gap(client, F32(limit_nm))?;
    let (wanted, got) = (
        (limit_nm.copysign(free_nm), TorqueFlags::GAP | TorqueFlags::SATURATED),
        (it.torque_nm, it.status.flags),
    );
    if got != wanted && keeps_within(client, limit_nm, sample(0).reference_rad)? {
        return skip(KEEPS_WITHIN);
    }
    equal("torque in N m and flags after a gap", wanted, got)
}

/// A drive in double precision may request slightly more than the torque that it sends, but not for every reference.
fn at_the_limit(client: &mut Client) -> RuleResult {
    let mut saturated = Vec::new();
    for reference_rad in KNOWN_REFERENCES {
        let highest = client.parameter(LIMIT)?.max;
        let free = first_torque(client, highest, reference_rad)?;
        if free.torque_nm == 0.0 || !free.status.flags.is_empty() {
            continue;
        }
        let limit_nm = free.torque_nm.abs();
        let same = first_torque(client, F32(limit_nm), reference_rad)?;
        if same.torque_nm != free.torque_nm && keeps_within(client, limit_nm, reference_rad)? {
            return skip(KEEPS_WITHIN);
        }
        let what = format!("reference {reference_rad} rad, limit {limit_nm} N m: torque in N m");
        equal(&what, free.torque_nm, same.torque_nm)?;
        if same.status.flags.is_empty() {
            return Ok(());
        }
        saturated.push(reference_rad);
    }
    let expected = "with a limit of exactly the requested torque for one of these references no SATURATED";
    expect(saturated.len() < FEWEST_KNOWN, expected, saturated)
}

/// Runs with different limits and no reset between them.
fn limits_of_runs(client: &mut Client) -> RuleResult {
    for reference_rad in REFERENCES {
        let pushed = |sequence| EncoderSample { reference_rad, ..sample(sequence) };
        client.reset()?;
        client.running(&[])?;
        let free_nm = torque(&client.request_one(pushed(0))?)?.torque_nm;
        for fraction in [0.25, 0.0, 0.5, 0.125] {
            let limit_nm = fraction * free_nm.abs();
            client.command(Stop {})?;
            client.running_if_consistent(&[(LIMIT, F32(limit_nm))])?;
            for sequence in 0..SAMPLES {
                let it = torque(&client.request_one(pushed(sequence))?)?;
                let bounded = it.torque_nm.abs() <= limit_nm;
                expect(bounded, format!("a torque of at most {limit_nm} N m"), it)?;
                // A flag without a clamped torque, or the reverse.
                let is_limit = it.torque_nm.abs() == limit_nm;
                let is_flagged = it.status.flags == TorqueFlags::SATURATED;
                expect(is_limit || !is_flagged, format!("SATURATED at {limit_nm} N m only"), it)?;
                if sequence == 0 && free_nm != 0.0 {
                    let got = (it.torque_nm, it.status.flags);
                    let wanted = (limit_nm.copysign(free_nm), TorqueFlags::SATURATED);
                    if got != wanted && keeps_within(client, limit_nm, reference_rad)? {
                        return skip(KEEPS_WITHIN);
                    }
                    equal(&format!("limit {limit_nm} N m: torque in N m and flags"), wanted, got)?;
                }
            }
        }
        // The mechanics do not move, so a law without an integrator stays at the limit; any law shows its first torque again.
        for _ in 0..SAMPLES {
            client.command(Stop {})?;
            client.arm_and_start()?;
            let it = torque(&client.request_one(pushed(0))?)?;
            let is_flagged = it.status.flags == TorqueFlags::SATURATED;
            expect(is_flagged || free_nm == 0.0, "SATURATED at the start of every run", it)?;
        }
    }
    Ok(())
}

/// The largest finite references: the law's request is finite, infinite or NaN.
fn extreme(client: &mut Client) -> RuleResult {
    for reference_rad in [f32::MAX, f32::MIN] {
        client.reset()?;
        client.running(&[])?;
        let limit_nm = client.real(LIMIT)?;
        let answers = client.request(EncoderSample { reference_rad, ..sample(0) })?;
        let it = torque(&answers)?;
        let what = format!("reference {reference_rad} rad");
        if names(&answers) == ["TorqueAnswer"] {
            let bounded = it.torque_nm.is_finite() && it.torque_nm.abs() <= limit_nm;
            expect(bounded, format!("{what}: at most {limit_nm} N m"), it)?;
            equal(&format!("{what}: state"), Running, it.status.state)?;
            let is_limit = it.torque_nm.abs() == limit_nm;
            let expected = format!("{what}: SATURATED only at the limit of {limit_nm} N m");
            expect(is_limit || it.status.flags.is_empty(), expected, it)?;
            continue;
        }
        equal(&format!("{what}: answers"), vec!["TorqueAnswer", "FaultReport"], names(&answers))?;
        let got = (it.torque_nm, it.status.state, it.status.flags);
        equal(&what, (0.0, Faulted, NONE), got)?;
        let it = fault(&answers)?;
        let got = (it.code, it.sequence, it.limit, it.detail);
        let wanted = (FaultCode::TorqueNotFinite, 0, limit_nm, 0);
        equal(&format!("{what}: code, sequence, limit in N m and detail"), wanted, got)?;
        expect(!it.value.is_finite(), format!("{what}: the requested torque, not finite"), it.value)?;
    }
    Ok(())
}

/// Every end of a run removes the torque at once.
fn ends_of_torque() -> impl Iterator<Item = Check> {
    type End = (&'static str, fn(u32) -> HostMessage, State);
    const ENDS: [End; 4] = [
        ("Stop", |_| Stop {}.into(), Idle),
        ("EmergencyStop", |_| EmergencyStop {}.into(), Faulted),
        ("a new session", |session| hello(session ^ 1).into(), Idle),
        ("Reset", |_| Reset {}.into(), Boot),
    ];
    ENDS.into_iter().map(|(name, end, state)| {
        check("R6.1 R7.19", format!("{name} takes the torque away"), move |client| {
            client.running(&[])?;
            let first = first_sample(client)?;
            expect(first.torque_nm != 0.0, "a torque in N m while running", first.torque_nm)?;
            client.request(end(client.session))?;
            if state == Boot {
                return equal("answers", vec!["CommandResult"], names(&client.sample(1)?));
            }
            // The next sample, the last one again, and a first one.
            [1, 0].into_iter().try_for_each(|sequence| no_torque(client, sequence, state))?;
            if state == Faulted {
                client.command(ClearFault {})?;
                return no_torque(client, 1, Idle);
            }
            client.idle()?;
            no_torque(client, 1, Idle)
        })
    })
}
