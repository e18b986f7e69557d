//! Faults that need no hand at the hardware: what exceeds a limit, and a reference that is not finite.

use std::f32::consts::TAU;
use std::time::Duration;

use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State, TorqueFlags};
use lashloop_protocol::message::{BenchSample, FaultReport, Stop, Subscribe};
use lashloop_protocol::{DriveMessage, EncoderCounts};

use super::super::assertion::{Failure, RuleResult, broken, equal, expect, skip};
use super::super::check::Check;
use super::super::client::Client;
use super::super::encoders::encoder::Encoder;
use super::super::exchanges::result;
use super::super::pins;
use super::super::range::nearest_real;
use super::super::reactions::{no_torque, still_reported};
use super::super::telemetry::subscription::signals;
use super::super::words::Words;
use super::run::{Run, TWIST_LIMIT_RAD, Timing, allowed};

/// Most steps between two reports, so that the report of the fault is not due otherwise.
const SELDOM: u32 = 1_000;
/// Time in which nothing follows a fault.
const SILENT: Duration = Duration::from_millis(130);
/// Steps of a motion, and the fewest counts in a period of a fast one.
const MOVING: usize = 150;
const FAST: f32 = 12.0;
/// Counts by which the fastest motion exceeds a limit, so that every drive finds it.
const CLEARLY: f32 = 3.0;

pub(super) fn checks() -> Vec<Check> {
    vec![
        allowed("R7.14 R18.1 R18.7", "a motor faster than its limit is a fault, with its step", |client| {
            too_fast(client, Encoder::MOTOR)
        }),
        allowed("R7.14 R18.1 R18.7", "a load faster than its limit is a fault, with its step", |client| {
            too_fast(client, Encoder::LOAD)
        }),
        allowed(
            "R7.14 R18.4",
            "a motor beyond a limit of half its speed is a fault, and Arm refuses afterwards",
            |client| half_as_fast(client, Encoder::MOTOR),
        ),
        allowed(
            "R7.14 R18.4",
            "a load beyond a limit of half its speed is a fault, and Arm refuses afterwards",
            |client| half_as_fast(client, Encoder::LOAD),
        ),
        allowed("R18.7 R18.12", "a change of the twist beyond its limit is a fault, with its step", twisted),
        allowed("R7.13 R18.1 R18.7", "a reference that is not finite is a fault, with its step", not_finite),
    ]
}

/// Steps at the smallest value of a limit, until it is exceeded.
fn at_least(
    client: &mut Client,
    limit: &'static str,
    every: u32,
) -> Result<(Vec<BenchSample>, Option<FaultReport>), Failure> {
    let least = client.parameter(limit)?.min;
    let timing = Timing::of_every(client, &[], every)?;
    Run::start_at(client, timing, &[(limit, least)])?.until_fault(1.0)
}

fn too_fast(client: &mut Client, encoder: Encoder) -> RuleResult {
    let name = encoder.speed_limit;
    let (reports, fault) = at_least(client, name, SELDOM)?;
    if let Some(it) = fault {
        equal("code and detail", (encoder.jump_fault, 0), (it.code, it.detail))?;
        exceeds(client, name, it)?;
        return ended_by(client, &reports, it);
    }
    // The fault must come if the encoder was that fast.
    client.reset()?;
    let ParameterValue::F32(least_rad_s) = client.parameter(name)?.min else {
        return skip("the speed limit has another type");
    };
    if exceeds_unnoticed(client, encoder, least_rad_s)? {
        return Err(broken(format!("a FaultReport at the smallest {name}"), "none"));
    }
    skip("the mechanics at the pins don't exceed the smallest limit")
}

/// Whether the encoder exceeds a limit by its reports, in a run at this limit that no fault ends.
fn exceeds_unnoticed(client: &mut Client, encoder: Encoder, limit_rad_s: f32) -> Result<bool, Failure> {
    let timing = Timing::of_every(client, &[], 1)?;
    let settings = [(encoder.speed_limit, ParameterValue::F32(limit_rad_s))];
    let (reports, fault) = Run::start_at(client, timing, &settings)?.until_fault(1.0)?;
    let limit_counts = limit_rad_s / rad_s_per_count(client, encoder);
    Ok(fault.is_none() && most_counts(&reports, encoder) > limit_counts + CLEARLY)
}

/// The speed of one count in a period.
fn rad_s_per_count(client: &Client, encoder: Encoder) -> f32 {
    TAU / counts_per_rev(client, encoder) / (1e-6 * client.identity.period_us as f32)
}

/// The most counts of an encoder from one step to the next.
fn most_counts(reports: &[BenchSample], encoder: Encoder) -> f32 {
    let counts = |it: &BenchSample| [it.motor_counts, it.load_counts][encoder.index];
    let next = |pair: &&[BenchSample]| pair[1].sequence == pair[0].sequence.wrapping_add(1);
    let moves = reports.windows(2).filter(next);
    let moves = moves.map(|pair| counts(&pair[1]).wrapping_sub(counts(&pair[0])).unsigned_abs());
    moves.max().unwrap_or(0) as f32
}

/// A limit of half the speed of a run, and of less than the fastest motion since power-up or `Reset`.
fn half_as_fast(client: &mut Client, encoder: Encoder) -> RuleResult {
    let name = encoder.speed_limit;
    let timing = Timing::of_every(client, &[], 1)?;
    let reports = Run::start_at(client, timing, &[])?.reports(MOVING, 1.0)?;
    let fastest = most_counts(&reports, encoder);
    let half = nearest_real(client.parameter(name)?, fastest / 2.0 * rad_s_per_count(client, encoder))?;
    if fastest < FAST || half > 0.75 * fastest * rad_s_per_count(client, encoder) {
        return skip("the mechanics at the pins move too little");
    }
    client.request(Stop {})?;
    client.put(name, ParameterValue::F32(half))?;
    let it = pins::arm(client)?;
    let wanted = (Outcome::EncoderImplausible, encoder.index as u32 + 2);
    let what = format!("Arm with {name} {half} after {fastest} counts in a period: outcome and detail");
    equal(&what, wanted, (it.outcome, it.detail))?;
    client.reset()?;
    expect(!exceeds_unnoticed(client, encoder, half)?, format!("a FaultReport above {half} rad/s"), "none")
}

/// As the identity has it: the parameter may be of either type.
fn counts_per_rev(client: &Client, encoder: Encoder) -> f32 {
    let it = &client.identity;
    [it.motor_counts_per_rev, it.load_counts_per_rev][encoder.index] as f32
}

fn twisted(client: &mut Client) -> RuleResult {
    let (reports, fault) = at_least(client, TWIST_LIMIT_RAD, SELDOM)?;
    let Some(it) = fault else {
        return skip("the mechanics at the pins don't exceed the smallest limit");
    };
    let code = match standing_still(&reports) {
        Some(code) => code,
        None if it.code == FaultCode::MotorEncoderLost => it.code,
        None => FaultCode::LoadEncoderLost,
    };
    equal("code and detail", (code, 0), (it.code, it.detail))?;
    exceeds(client, TWIST_LIMIT_RAD, it)?;
    ended_by(client, &reports, it)
}

/// The fault of the encoder that has not moved since the first step while the other one has.
fn standing_still(reports: &[BenchSample]) -> Option<FaultCode> {
    let (first, last) = reports.first().zip(reports.last())?;
    let moved = |from: EncoderCounts, to: EncoderCounts| from != to;
    match (moved(first.motor_counts, last.motor_counts), moved(first.load_counts, last.load_counts)) {
        (true, false) => Some(FaultCode::LoadEncoderLost),
        (false, true) => Some(FaultCode::MotorEncoderLost),
        _ => None,
    }
}

fn not_finite(client: &mut Client) -> RuleResult {
    for reference_rad in [f32::NAN, f32::NEG_INFINITY] {
        client.reset()?;
        let timing = Timing::of_every(client, &[], SELDOM)?;
        if let Ok(signals) = signals(client) {
            client.idle()?;
            client.exchange(
                "in Idle",
                &[result(Subscribe { signals, every: 1 }, Outcome::Accepted, State::Idle)],
            )?;
        }
        let mut run = Run::start_at(client, timing, &[])?;
        run.reports(1, 0.5)?;
        let (reports, fault) = run.until_fault(reference_rad)?;
        let Some(it) = fault else { return Err(broken("a FaultReport", "none")) };
        equal("code and detail", (FaultCode::ReferenceNotFinite, 0), (it.code, it.detail))?;
        let is_reference = it.value == reference_rad || (it.value.is_nan() && reference_rad.is_nan());
        expect(is_reference && it.limit == 0.0, "the reference as its value, and no limit", it)?;
        ended_by(client, &reports, it)?;
    }
    Ok(())
}

/// Requires the value of a fault to exceed its limit, which is the smallest one of this parameter.
fn exceeds(client: &Client, limit: &str, it: FaultReport) -> RuleResult {
    let least = client.parameter(limit)?.min;
    equal(&format!("limit of the FaultReport, {limit},"), least, ParameterValue::F32(it.limit))?;
    expect(it.value.is_finite() && it.value >= it.limit, "a value above the limit", it)
}

/// Requires the report of the step that caused a fault as the last one, and no torque from it on.
fn ended_by(client: &mut Client, reports: &[BenchSample], it: FaultReport) -> RuleResult {
    let Some((last, before)) = reports.split_last() else {
        return Err(broken("a BenchSample of the step that caused the fault", it.words()));
    };
    let got = (last.sequence, last.torque_nm, last.status.state, last.status.flags);
    let wanted = (it.sequence, 0.0, State::Faulted, TorqueFlags::empty());
    equal("sequence, torque in N m, state and flags of the last BenchSample", wanted, got)?;
    let early: Vec<_> = before.iter().map(|it| it.status.state).filter(|it| *it != State::Running).collect();
    equal("other states before it:", Vec::new(), early)?;
    let later =
        client.wait_for(SILENT, |message| (!matches!(message, DriveMessage::Log(_))).then_some(*message))?;
    equal("messages after the FaultReport:", None, later)?;
    no_torque(client, it.sequence, State::Faulted)?;
    still_reported(client, it)
}
