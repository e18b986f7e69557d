//! Safety: torque limit, latched faults and watchdog.

use std::time::Duration;

use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{ClearFault, EmergencyStop, EncoderSample, FaultReport, Reset, Stop};
use lashloop_protocol::{DriveMessage, HostMessage};

use super::answers::{fault, hello, sample};
use super::assertion::{Failure, RuleResult, broken, equal, expect, names};
use super::check::{Check, check};
use super::client::Client;
use super::reactions::{fault_answer, no_torque};

/// Watchdog of these checks: short for a quick check, long enough for the first sample of a busy bench.
const WATCHDOG: Duration = Duration::from_millis(100);
/// Time between two copies of a sample.
const REPEAT_INTERVAL: Duration = Duration::from_millis(1);
/// Timeout for a watchdog that must trip.
const WATCHDOG_PATIENCE: Duration = Duration::from_secs(1);
/// Tolerated error of the drive's clock, as a fraction.
const CLOCK_TOLERANCE: f64 = 0.1;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R8", "a torque beyond the limit is limited and flagged SATURATED", limited),
        check("R8", "EmergencyStop is answered with its fault", |client| {
            client.running(&[])?;
            client.torque(0)?;
            let answers = client.request(EmergencyStop {})?;
            equal("answers", vec!["FaultReport", "CommandResult"], names(&answers))?;
            let it = fault(&answers)?;
            equal("code and sequence", (FaultCode::EmergencyStop, 0), (it.code, it.sequence))
        }),
        check("R8", "a fault stays latched through Stop and samples", |client| {
            client.faulted()?;
            client.request(Stop {})?;
            client.sample(0)?;
            equal("state", State::Faulted, client.state)
        }),
        check("R8", "the first fault stays latched", |client| {
            client.running(&[])?;
            client.request(EncoderSample { reference_rad: f32::NAN, ..sample(0) })?;
            client.request(EmergencyStop {})?;
            let answers = client.request(hello(client.session))?;
            equal("fault reported after the identity", FaultCode::ReferenceNotFinite, fault(&answers)?.code)
        }),
        check("R8", "a cleared fault restores no torque", |client| {
            client.running(&[])?;
            client.torque(0)?;
            client.request(EmergencyStop {})?;
            equal("ClearFault", (Outcome::Accepted, State::Idle), client.command(ClearFault {})?)?;
            no_torque(client, 1, State::Idle)
        }),
        check("R8", "without samples the watchdog trips, and not early", watchdog_trips),
        check("R8", "after the watchdog has tripped there is no torque", |client| {
            await_watchdog(client)?;
            no_torque(client, 1, State::Faulted)
        }),
        check("R8", "repeating one sample does not feed the watchdog", |client| {
            start_with_watchdog(client)?;
            let give_up = client.line.now() + WATCHDOG_PATIENCE;
            while client.state == State::Running && client.line.now() < give_up {
                client.sample(0)?;
                // Time passes for a drive in process only while the bench waits.
                client.wait_for(REPEAT_INTERVAL, |_| None::<()>)?;
            }
            equal("state", State::Faulted, client.state)
        }),
        check("R8", "a reference that is not finite is a fault", |client| {
            for reference_rad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                client.reset()?;
                client.running(&[])?;
                client.torque(0)?;
                let answers = client.request(EncoderSample { reference_rad, ..sample(1) })?;
                fault_answer(&answers, FaultCode::ReferenceNotFinite)?;
                no_torque(client, 2, State::Faulted)?;
            }
            Ok(())
        }),
    ];
    checks.extend(ends_of_torque());
    checks
}

/// Every end of a run removes the torque.
fn ends_of_torque() -> impl Iterator<Item = Check> {
    type End = (&'static str, fn(u32) -> HostMessage, State);
    const ENDS: [End; 4] = [
        ("Stop", |_| Stop {}.into(), State::Idle),
        ("EmergencyStop", |_| EmergencyStop {}.into(), State::Faulted),
        ("a new session", |session| hello(session ^ 1).into(), State::Idle),
        ("Reset", |_| Reset {}.into(), State::Boot),
    ];
    ENDS.into_iter().map(|(name, end, state)| {
        check("R8", format!("{name} takes the torque away"), move |client| {
            client.running(&[])?;
            expect(client.torque(0)?.torque_nm != 0.0, "a torque while running", "none")?;
            client.request(end(client.session))?;
            if state == State::Boot {
                return equal("answers", vec!["CommandResult"], names(&client.sample(1)?));
            }
            no_torque(client, 1, state)
        })
    })
}

fn limited(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    let free = client.torque(0)?;
    let limit_nm = free.torque_nm.abs() / 2.0;
    client.reset()?;
    client.running(&[("torque_limit_nm", ParameterValue::F32(limit_nm))])?;
    let answer = client.torque(0)?;
    let wanted = (limit_nm.copysign(free.torque_nm), TorqueFlags::SATURATED);
    equal("torque and flags", wanted, (answer.torque_nm, answer.status.flags))?;
    client.reset()?;
    // A law may request more torque at a higher limit, so only the highest one is far away.
    let highest = client.parameter("torque_limit_nm")?.max;
    client.running(&[("torque_limit_nm", highest)])?;
    equal("far from the limit the flags", TorqueFlags::empty(), client.torque(0)?.status.flags)
}

/// Starts a run with the short watchdog and sends one sample.
fn start_with_watchdog(client: &mut Client) -> RuleResult {
    client.idle()?;
    client.put("watchdog_us", ParameterValue::U32(WATCHDOG.as_micros() as u32))?;
    client.arm()?;
    client.start()?;
    client.torque(0).map(drop)
}

fn await_watchdog(client: &mut Client) -> Result<FaultReport, Failure> {
    start_with_watchdog(client)?;
    let tripped = client.wait_for(WATCHDOG_PATIENCE, |message| match message {
        DriveMessage::FaultReport(fault) => Some(*fault),
        _ => None,
    })?;
    tripped.ok_or_else(|| {
        let got = format!("none within {WATCHDOG_PATIENCE:?}");
        broken(format!("a FaultReport {WATCHDOG:?} after the last sample"), got)
    })
}

fn watchdog_trips(client: &mut Client) -> RuleResult {
    let asked = client.line.now();
    let it = await_watchdog(client)?;
    let waited_s = (client.line.now() - asked).as_secs_f64();
    equal("code and sequence", (FaultCode::Watchdog, 0), (it.code, it.sequence))?;
    let limit_s = WATCHDOG.as_secs_f32();
    expect((it.limit - limit_s).abs() <= 1e-6, format!("limit {limit_s} s"), it.limit)?;
    expect(it.value >= it.limit, format!("a silence of at least {limit_s} s"), it.value)?;
    let least_s = WATCHDOG.as_secs_f64() * (1.0 - CLOCK_TOLERANCE);
    expect(waited_s >= least_s, format!("at least {least_s} s on the bench's clock"), waited_s)?;
    client.note = format!("tripped {:.1} ms after the last sample, device time", 1e3 * it.value);
    Ok(())
}
