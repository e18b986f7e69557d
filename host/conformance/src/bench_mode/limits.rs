//! Faults that need no hand at the hardware: what exceeds a limit, and a reference that is not finite.

use std::f32::consts::TAU;

use super::super::pins;
use super::super::telemetry::subscription::signals;
use super::run::{Run, TWIST_LIMIT_RAD, Timing, allowed};
use crate::prelude::checks::*;

/// The ratio of the twist, if the drive has it as a parameter.
const REDUCTION_RATIO: &str = "reduction_ratio";
/// Most steps between two reports, so that the report of the fault is not due otherwise.
const SELDOM: u32 = 1_000;
/// Time in which nothing follows a fault.
const SILENT: Duration = Duration::from_millis(130);
/// A limit of the twist, in rad.
const TWIST_RAD: f32 = 0.02;
/// Steps of a motion, and the fewest counts in a period of a fast one.
const MOVING: usize = 150;
const FAST: f32 = 12.0;
/// Counts by which the fastest motion exceeds a limit, so that every drive finds it.
const CLEARLY: f32 = 3.0;

pub(super) fn checks() -> Vec<Check> {
    let smallest = Encoder::BOTH.map(|encoder| {
        let name = format!("a {} faster than its limit is a fault, with its step", encoder.name);
        allowed("R7.14 R18.1 R18.7", name, move |client| too_fast(client, encoder))
    });
    let half = Encoder::BOTH.map(|encoder| {
        let rule = "beyond a limit of half its speed is a fault, and Arm refuses afterwards";
        allowed("R7.14 R18.4", format!("a {} {rule}", encoder.name), move |client| {
            half_as_fast(client, encoder)
        })
    });
    let others = [
        allowed("R18.7 R18.12", "a change of the twist beyond its limit is a fault, with its step", twisted),
        allowed("R7.13 R18.1 R18.7", "a reference that is not finite is a fault, with its step", not_finite),
    ];
    smallest.into_iter().chain(half).chain(others).collect()
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
    let F32(least_rad_s) = client.parameter(name)?.min else {
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
    let settings = [(encoder.speed_limit, F32(limit_rad_s))];
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

/// A limit of half the speed of a run, and of less than the fastest motion since power-up or `Reset`, in either direction.
fn half_as_fast(client: &mut Client, encoder: Encoder) -> RuleResult {
    for reference_rad in [1.0, -1.0] {
        client.reset()?;
        half_of_a_run(client, encoder, reference_rad)?;
    }
    Ok(())
}

fn half_of_a_run(client: &mut Client, encoder: Encoder, reference_rad: f32) -> RuleResult {
    let name = encoder.speed_limit;
    let timing = Timing::of_every(client, &[], 1)?;
    let reports = Run::start_at(client, timing, &[])?.reports(MOVING, reference_rad)?;
    let fastest = most_counts(&reports, encoder);
    let half = nearest_real(client.parameter(name)?, fastest / 2.0 * rad_s_per_count(client, encoder))?;
    if fastest < FAST || half > 0.75 * fastest * rad_s_per_count(client, encoder) {
        return skip("the mechanics at the pins move too little");
    }
    client.request(Stop {})?;
    client.put(name, F32(half))?;
    let it = pins::arm(client)?;
    let wanted = (EncoderImplausible, encoder.index as u32 + 2);
    let what = format!("Arm with {name} {half} after {fastest} counts in a period: outcome and detail");
    equal(&what, wanted, (it.outcome, it.detail))?;
    // The duties come first, and in HIL mode the pins don't count.
    let offset = client.parameter("duty_offset")?.default;
    let [least, most] = [client.parameter("duty_offset")?.min, client.parameter("duty_min")?.default];
    if least != most {
        client.put("duty_offset", least)?;
        equal("Arm with inconsistent duties too", Inconsistent, pins::arm(client)?.outcome)?;
        client.put("duty_offset", offset)?;
    }
    client.put(SAMPLE_SOURCE, U32(0))?;
    client.exchange("in HIL mode", &[result(Arm { session: client.session }, Accepted, Armed)])?;
    client.reset()?;
    expect(!exceeds_unnoticed(client, encoder, half)?, format!("a FaultReport above {half} rad/s"), "none")?;
    // What `Reset` forgets no longer counts, once the mechanics rest.
    client.reset()?;
    let reports = Run::start_at(client, timing, &[])?.reports(2, 0.0)?;
    if 4.0 * most_counts(&reports, encoder) > fastest {
        return Ok(());
    }
    client.reset()?;
    client.idle()?;
    pins::widest_duties(client)?;
    client.put(name, F32(half))?;
    let it = pins::arm(client)?;
    expect(it.outcome != EncoderImplausible, "Arm after Reset, with mechanics at rest", it)
}

/// As the identity has it: the parameter may be of either type.
fn counts_per_rev(client: &Client, encoder: Encoder) -> f32 {
    let it = &client.identity;
    [it.motor_counts_per_rev, it.load_counts_per_rev][encoder.index] as f32
}

fn twisted(client: &mut Client) -> RuleResult {
    let (reports, fault) = at_least(client, TWIST_LIMIT_RAD, SELDOM)?;
    let mut is_judged = fault.is_some();
    if let Some(it) = fault {
        equal("code and detail", (lost_code(it, None), 0), (it.code, it.detail))?;
        exceeds(client, TWIST_LIMIT_RAD, it)?;
        ended_by(client, &reports, it)?;
    }
    for reference_rad in [1.0, -1.0] {
        client.reset()?;
        is_judged |= twisted_as_reported(client, reference_rad)?;
    }
    if is_judged { Ok(()) } else { skip("the mechanics at the pins don't exceed the smallest limit") }
}

/// Compares the faults of a run with the twist of its reports. Returns whether the twist exceeded its limit.
fn twisted_as_reported(client: &mut Client, reference_rad: f32) -> Result<bool, Failure> {
    let limit_rad = nearest_real(client.parameter(TWIST_LIMIT_RAD)?, TWIST_RAD)?;
    // Without such a parameter a load that stands still has no part in the twist.
    let ratio = client.real(REDUCTION_RATIO).ok();
    let rad = [Encoder::MOTOR, Encoder::LOAD].map(|encoder| TAU / counts_per_rev(client, encoder));
    let timing = Timing::of_every(client, &[], 1)?;
    let settings = [(TWIST_LIMIT_RAD, F32(limit_rad))];
    let (reports, fault) = Run::start_at(client, timing, &settings)?.until_fault(reference_rad)?;
    let Some(first) = reports.first() else { return Ok(false) };
    let moved = |it: &BenchSample| {
        let counts = [
            it.motor_counts.wrapping_sub(first.motor_counts),
            it.load_counts.wrapping_sub(first.load_counts),
        ];
        match ratio {
            Some(ratio) => Some([counts[0] as f32 * rad[0], counts[1] as f32 * rad[1] * ratio]),
            None => (counts[1] == 0).then_some([counts[0] as f32 * rad[0], 0.0]),
        }
    };
    let twist_rad = |it: &BenchSample| moved(it).map_or(0.0, |[motor, load]| (motor - load).abs());
    let Some(it) = fault else {
        let most_rad = reports.iter().map(twist_rad).fold(0.0, f32::max);
        expect(
            most_rad <= 1.1 * limit_rad,
            format!("a FaultReport, with a twist of {most_rad} rad"),
            "none",
        )?;
        return Ok(false);
    };
    let last = reports.last().filter(|last| moved(last).is_some());
    equal("code and detail", (lost_code(it, last.and_then(moved)), 0), (it.code, it.detail))?;
    equal("limit of the FaultReport in rad", limit_rad, it.limit)?;
    is_above(it)?;
    if let Some(last) = last {
        let twist_rad = twist_rad(last);
        let is_that = (it.value - twist_rad).abs() <= 1e-3 * twist_rad + 2.0 * rad[0];
        expect(is_that, format!("a value of {twist_rad} rad, the change of the twist"), it)?;
    }
    ended_by(client, &reports, it)?;
    Ok(true)
}

/// Code of the encoder that has moved less, in rad at the motor; either one if both have moved alike, or that isn't known.
fn lost_code(it: FaultReport, moved_rad: Option<[f32; 2]>) -> FaultCode {
    match moved_rad.map(|moved_rad| moved_rad.map(f32::abs)) {
        Some([motor, load]) if 2.0 * motor < load => FaultCode::MotorEncoderLost,
        Some([motor, load]) if 2.0 * load < motor => FaultCode::LoadEncoderLost,
        _ if it.code == FaultCode::MotorEncoderLost => it.code,
        _ => FaultCode::LoadEncoderLost,
    }
}

fn not_finite(client: &mut Client) -> RuleResult {
    for reference_rad in [f32::NAN, f32::NEG_INFINITY] {
        client.reset()?;
        let timing = Timing::of_every(client, &[], SELDOM)?;
        if let Ok(signals) = signals(client) {
            client.idle()?;
            client.exchange("in Idle", &[result(Subscribe { signals, every: 1 }, Accepted, Idle)])?;
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
    equal(&format!("limit of the FaultReport, {limit},"), least, F32(it.limit))?;
    is_above(it)
}

fn is_above(it: FaultReport) -> RuleResult {
    expect(it.value.is_finite() && it.value >= it.limit, "a value above the limit", it)
}

/// Requires the report of the step that caused a fault as the last one, and no torque from it on.
fn ended_by(client: &mut Client, reports: &[BenchSample], it: FaultReport) -> RuleResult {
    let Some((last, before)) = reports.split_last() else {
        return Err(broken("a BenchSample of the step that caused the fault", it.words()));
    };
    let got = (last.sequence, last.torque_nm, last.status.state, last.status.flags);
    let wanted = (it.sequence, 0.0, Faulted, NONE);
    equal("sequence, torque in N m, state and flags of the last BenchSample", wanted, got)?;
    let early: Vec<_> = before.iter().map(|it| it.status.state).filter(|it| *it != Running).collect();
    equal("other states before it:", Vec::new(), early)?;
    let later = client.wait_for(SILENT, |message| (!is::<Log>(message)).then_some(*message))?;
    equal("messages after the FaultReport:", None, later)?;
    no_torque(client, it.sequence, Faulted)?;
    // A later one replaces nothing.
    client.request(EmergencyStop {})?;
    still_reported(client, it)
}
