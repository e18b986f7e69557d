//! The torques of bench mode are those of HIL mode.

use lashloop_protocol::enums::{ParameterValue, TorqueFlags};
use lashloop_protocol::message::{BenchSample, EncoderSample};
use lashloop_protocol::parameter_names::{CONTROLLER, TORQUE_LIMIT_NM};

use super::super::answers::torque;
use super::super::assertion::{Failure, RuleResult, broken, equal, skip};
use super::super::check::Check;
use super::super::client::Client;
use super::super::range::nearest_real;
use super::super::words::{Bits, Words};
use super::run::{Run, Timing, allowed, in_turn, is_report, report};

/// Directions of encoders and power stage.
const MIRRORED: [&str; 3] = ["motor_direction", "load_direction", "torque_direction"];
/// Steps that are compared.
const STEPS: usize = 60;

pub(super) fn checks() -> Vec<Check> {
    vec![
        allowed(
            "R18.1 R18.2",
            "equal counts and references give the torques of HIL mode, limited and reversed too",
            same_torques,
        ),
        allowed("R18.1", "every law gives the torques of HIL mode", every_law),
    ]
}

fn same_torques(client: &mut Client) -> RuleResult {
    let largest_nm = compare(client, &[])?;
    if largest_nm != 0.0 {
        client.reset()?;
        let limit_nm = nearest_real(client.parameter(TORQUE_LIMIT_NM)?, largest_nm / 2.0)?;
        compare(client, &[(TORQUE_LIMIT_NM, ParameterValue::F32(limit_nm))])?;
    }
    client.reset()?;
    // Both encoders and the power stage: the same machine, seen from the other end.
    compare(client, &MIRRORED.map(|name| (name, ParameterValue::U32(1)))).map(drop)
}

fn every_law(client: &mut Client) -> RuleResult {
    if client.parameter(CONTROLLER).is_err() {
        return skip("the drive has one law");
    }
    for law in client.description.laws.clone() {
        client.reset()?;
        compare(client, &[(CONTROLLER, ParameterValue::U32(law.index.into()))])?;
    }
    Ok(())
}

/// The drive itself in HIL mode is the reference: its own counts and references as samples. Returns the largest torque in N m.
fn compare(client: &mut Client, settings: &[(&'static str, ParameterValue)]) -> Result<f32, Failure> {
    let timing = Timing::fitted(client, settings)?;
    if timing.every != 1 {
        return skip("not judged: this line is too slow for a report of every step");
    }
    let mut run = Run::start_at(client, timing, settings)?;
    let (messages, sent) = run.until(STEPS, is_report, |turn| 0.25 * f32::from(turn % 5))?;
    let reports: Vec<_> = messages.iter().filter_map(report).collect();
    in_turn(&reports, 1)?;
    client.reset()?;
    client.running(settings)?;
    let mut largest_nm = 0.0_f32;
    for it in reports {
        let of_step = sent.iter().find(|(number, _)| *number == it.reference_number);
        let Some((_, reference_rad)) = of_step else {
            return Err(broken("the number of a Reference that was sent", it.reference_number.words()));
        };
        let BenchSample { sequence, motor_counts, load_counts, .. } = it;
        let sample = EncoderSample { sequence, motor_counts, load_counts, reference_rad: *reference_rad };
        let answer = torque(&client.request_one(sample)?)?;
        let of = |torque_nm: f32, flags: TorqueFlags| (Bits(torque_nm.to_bits()), flags);
        equal(
            &format!("torque in N m and flags of step {sequence}, as in HIL mode,"),
            of(answer.torque_nm, answer.status.flags),
            of(it.torque_nm, it.status.flags),
        )?;
        largest_nm = largest_nm.max(it.torque_nm.abs());
    }
    Ok(largest_nm)
}
