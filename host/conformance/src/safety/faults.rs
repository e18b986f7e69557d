//! Latched faults: their reports, and what clears them.

use super::super::reactions::{fault_answer_with, reported_to, same_report};
use crate::prelude::checks::*;

/// Time after which a fault must still be latched.
const LATCHED: Duration = Duration::from_millis(150);

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R5.2 R8.3 R8.4", "EmergencyStop is answered with its fault", emergency_stop),
        check("R8.2", "a fault stays latched through Stop and samples", |client| {
            client.running(&[])?;
            first_sample(client)?;
            let it = stopped(client, 0)?;
            stays_latched(client, it)
        }),
        check("R8.3", "the first fault stays latched", |client| {
            client.running(&[])?;
            first_sample(client)?;
            let answers = client.request(EncoderSample { reference_rad: f32::NAN, ..sample(1) })?;
            let first = fault_answer(&answers, FaultCode::ReferenceNotFinite)?;
            for _ in 0..2 {
                stopped(client, 1)?;
                still_reported(client, first)?;
            }
            stays_latched(client, first)
        }),
        check("R6.1 R8.2", "a cleared fault restores no torque", |client| {
            client.running(&[])?;
            first_sample(client)?;
            stopped(client, 0)?;
            equal("ClearFault", (Accepted, Idle), client.command(ClearFault {})?)?;
            no_torque(client, 1, Idle)?;
            no_torque(client, 0, Idle)
        }),
        check("R8.1 R8.4", "a fault after a cleared one has its own report", |client| {
            client.running(&[])?;
            for sequence in 0..3 {
                accepted(client, sample(sequence), NONE)?;
            }
            stopped(client, 2)?;
            client.command(ClearFault {})?;
            // The run has ended, and its last sample is still the last accepted.
            stopped(client, 2)?;
            client.command(ClearFault {})?;
            let answers = client.request(hello(client.session))?;
            of_kinds("to Hello without a fault", &["Identity"], answers)?;
            client.arm()?;
            stopped(client, 2)?;
            client.command(ClearFault {})?;
            client.arm_and_start()?;
            let answers = client.request(EncoderSample { reference_rad: f32::INFINITY, ..sample(0) })?;
            let it = fault_answer(&answers, FaultCode::ReferenceNotFinite)?;
            still_reported(client, it)
        }),
        check("R8.2 R8.4", "a reset clears a fault and the sequence of its report", |client| {
            client.running(&[])?;
            first_sample(client)?;
            accepted(client, sample(1), NONE)?;
            stopped(client, 1)?;
            equal("Reset", (Accepted, Boot), client.command(Reset {})?)?;
            equal("to Hello", vec!["Identity"], names(&client.request(hello(client.session))?))?;
            stopped(client, 0).map(drop)
        }),
        check("R7.13 R7.16 R5.2", "a reference that is not finite is a fault", not_finite),
        check("R7.13 R7.14", "one fault of several is reported, in the order of the checks", order_of_checks),
    ];
    checks.extend(Encoder::BOTH.into_iter().map(|encoder| {
        let name = format!("a jump of the {} encoder stays latched, with its report", encoder.name);
        check("R8.2 R7.14", name, move |client| {
            let setup = Setup::coarse(client)?;
            let counts = setup.scale(encoder).jump_counts()?;
            setup.start(client)?;
            first_sample(client)?;
            let it = fault_answer(&client.request(placed(encoder, 1, -counts))?, encoder.jump_fault)?;
            stays_latched(client, it)
        })
    }));
    checks
}

/// Sends an `EmergencyStop` and requires its report, which has no value and no limit.
fn stopped(client: &mut Client, sequence: u16) -> Result<FaultReport, Failure> {
    let kinds = ["FaultReport", "CommandResult"];
    let answers = of_kinds("to EmergencyStop", &kinds, client.request(EmergencyStop {})?)?;
    equal("state", Faulted, client.state)?;
    let (code, got) = (FaultCode::EmergencyStop, fault(&answers)?);
    same_report("to EmergencyStop", latched(code, sequence, 0.0), got)?;
    Ok(got)
}

fn emergency_stop(client: &mut Client) -> RuleResult {
    client.in_states(State::ALL, |client, _| {
        let it = stopped(client, 0)?;
        [0, 1].into_iter().try_for_each(|sequence| no_torque(client, sequence, Faulted))?;
        still_reported(client, it)
    })?;
    client.reset()?;
    client.running(&[])?;
    for sequence in 0..3 {
        accepted(client, sample(sequence), NONE)?;
    }
    // A repeated and a stray sample are not accepted.
    client.sample(2)?;
    client.sample(1)?;
    stopped(client, 2).map(drop)
}

/// Nothing but `ClearFault` and `Reset` clears a fault, and its report does not change.
pub(super) fn stays_latched(client: &mut Client, report: FaultReport) -> RuleResult {
    still_reported(client, report)?;
    [0, 1, report.sequence].into_iter().try_for_each(|sequence| no_torque(client, sequence, Faulted))?;
    equal("Stop", (WrongState, Faulted), client.command(Stop {})?)?;
    let news = client.wait_for(LATCHED, of::<FaultReport>)?;
    expect(news.is_none(), "one FaultReport for one fault", news)?;
    reported_to(client, client.session ^ 1, report)?;
    reported_to(client, client.session, report)?;
    no_torque(client, report.sequence.wrapping_add(1), Faulted)
}

fn not_finite(client: &mut Client) -> RuleResult {
    let longest = Setup::coarse(client)?.longest_gap();
    for (reference_rad, sequence) in [
        (f32::NAN, 1),
        (f32::INFINITY, 1),
        (f32::NEG_INFINITY, 1),
        (-f32::NAN, 0),
        (f32::INFINITY, 0),
        (f32::NEG_INFINITY, longest),
    ] {
        client.reset()?;
        Setup::coarse(client)?.start(client)?;
        if sequence > 0 {
            first_sample(client)?;
        }
        let flags = if sequence > 1 { TorqueFlags::GAP } else { NONE };
        let answers = client.request(EncoderSample { reference_rad, ..sample(sequence) })?;
        let it = fault_answer_with(&answers, FaultCode::ReferenceNotFinite, flags)?;
        let wanted = latched(it.code, sequence, reference_rad);
        same_report("to a reference that is not finite", wanted, it)?;
        still_reported(client, it)?;
        no_torque(client, sequence, Faulted)?;
        no_torque(client, sequence + 1, Faulted)?;
    }
    Ok(())
}

fn order_of_checks(client: &mut Client) -> RuleResult {
    let setup = Setup::coarse(client)?;
    let [motor, load] = Encoder::BOTH.map(|it| setup.scale(it).jump_counts());
    let (motor, load) = (motor?, load?);
    for (reference_rad, code) in
        [(f32::NAN, FaultCode::ReferenceNotFinite), (1.0, FaultCode::MotorEncoderJump)]
    {
        client.reset()?;
        setup.start(client)?;
        first_sample(client)?;
        let mut jump = EncoderSample { reference_rad, ..placed(Encoder::MOTOR, 1, motor) };
        *(Encoder::LOAD.counts_mut)(&mut jump) = lashloop_protocol::EncoderCounts::wrapping(-load);
        let it = fault_answer(&client.request(jump)?, code)?;
        still_reported(client, it)?;
    }
    Ok(())
}
