//! Whether a value that a drive accepted has an effect.

use std::f64::consts::TAU;

use lashloop_protocol::EncoderCounts;
use lashloop_protocol::enums::{FaultCode, Outcome, ParameterValue, State};
use lashloop_protocol::message::{Arm, EncoderSample, SetParameter};
use lashloop_protocol::parameter_names::{REQUIRED, WATCHDOG_US};

use lashloop_session::Parameter;

use super::super::answers::{outcome, sample, torque};
use super::super::assertion::{Failure, RuleResult, equal, expect, skip};
use super::super::check::{Check, check};
use super::super::client::{CONTROLLER, Client};
use super::super::handshake::put;
use super::super::range::{nearest_real, neighbour, within};
use super::super::reactions::fault_answer;

/// Speed limit of the checks, in counts per period.
const COUNTS_PER_PERIOD: f64 = 500.0;
/// Samples of a run that shows the effect of a live parameter.
const STEPS: u16 = 14;
/// Last sample before a setting in `Running`.
const BEFORE: u16 = 10;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check(
            "R7.14 R9.6 R9.12",
            "period and counts per revolution have an effect on the speed of an encoder",
            speeds,
        ),
        check("R9.5", "a live parameter set in Armed has the effect of one set in Idle", live_in_armed),
        check("R9.5", "a live parameter set in Running has an effect from the next sample", live_in_running),
    ]
}

/// One encoder of a drive: names of its parameters, its field and its fault.
struct Side {
    name: &'static str,
    counts_per_rev: &'static str,
    speed_limit: &'static str,
    place: fn(&mut EncoderSample, EncoderCounts),
    fault: FaultCode,
}

const SIDES: [Side; 2] = [
    Side {
        name: "motor",
        counts_per_rev: "motor_counts_per_rev",
        speed_limit: "motor_speed_limit_rad_s",
        place: |sample, counts| sample.motor_counts = counts,
        fault: FaultCode::MotorEncoderJump,
    },
    Side {
        name: "load",
        counts_per_rev: "load_counts_per_rev",
        speed_limit: "load_speed_limit_rad_s",
        place: |sample, counts| sample.load_counts = counts,
        fault: FaultCode::LoadEncoderJump,
    },
];

fn speeds(client: &mut Client) -> RuleResult {
    for wished in [[500, 20_000, 3_000], [4_000, 3_000, 20_000]] {
        for side in SIDES {
            for sign in [1, -1] {
                speed(client, wished, &side, sign)?;
            }
        }
    }
    Ok(())
}

/// The number in force, of either type.
fn number(client: &mut Client, name: &str) -> Result<f64, Failure> {
    let index = client.parameter(name)?.index;
    Ok(match client.get(index)?.value {
        ParameterValue::U32(value) => value.into(),
        ParameterValue::F32(value) => value.into(),
    })
}

/// Moves an encoder by half its limit, which is accepted, and then by 1.5 times its limit, which is a fault with the speed.
fn speed(client: &mut Client, wished: [u32; 3], side: &Side, sign: i64) -> RuleResult {
    client.reset()?;
    client.idle()?;
    put(client, wished)?;
    let period_s = number(client, "period_us")? * 1e-6;
    let mut limits = [(0.0_f32, 0.0, 0.0); 2];
    for (it, limit) in SIDES.iter().zip(&mut limits) {
        let per_count_rad_s = TAU / number(client, it.counts_per_rev)? / period_s;
        let wished_rad_s = (COUNTS_PER_PERIOD * per_count_rad_s) as f32;
        let limit_rad_s = nearest_real(client.parameter(it.speed_limit)?, wished_rad_s)?;
        *limit = (limit_rad_s, f64::from(limit_rad_s) / per_count_rad_s, per_count_rad_s);
        client.put(it.speed_limit, ParameterValue::F32(limit_rad_s))?;
    }
    let (limit_rad_s, counts_per_period, per_count_rad_s) = limits[usize::from(side.name == "load")];
    let counts = (1.5 * counts_per_period).ceil() + 2.0;
    let most = f64::from(EncoderCounts::MAX.get());
    if counts > most || limits.iter().any(|(_, counts, _)| counts + 1.0 > most) {
        return skip(
            "not run: the encoders, period and speed limits of this drive leave positions ambiguous",
        );
    }
    client.long_watchdog()?;
    client.arm()?;
    client.start()?;
    client.torque(0)?;
    let slow = sign * (0.5 * counts_per_period) as i64;
    let when = format!("{} moved by {slow} counts in a period, limit {counts_per_period:.1}", side.name);
    equal(&format!("{when}: state"), State::Running, torque(&moved(client, side, 1, slow)?)?.status.state)?;
    let answers = moved(client, side, 2, slow + sign * counts as i64)?;
    let it = fault_answer(&answers, side.fault)?;
    equal(&format!("{when}: limit in rad/s"), limit_rad_s, it.limit)?;
    // The report may omit the sign, and one count of quantisation adds to the speed.
    let speed_rad_s = (counts - 1.0) * per_count_rad_s;
    let off_rad_s = (f64::from(it.value.abs()) - speed_rad_s).abs();
    let near = off_rad_s <= 1.01 * per_count_rad_s + 1e-5 * speed_rad_s;
    expect(near, format!("{when}, then {counts} in the next: a speed of {speed_rad_s} rad/s"), it.value)
}

fn moved(
    client: &mut Client,
    side: &Side,
    sequence: u16,
    counts: i64,
) -> Result<Vec<lashloop_protocol::DriveMessage>, Failure> {
    let mut sample = sample(sequence);
    (side.place)(&mut sample, EncoderCounts::wrapping(counts));
    client.request(sample)
}

/// When a run gets the value of the parameter under test.
#[derive(Clone, Copy, PartialEq)]
enum Set {
    Never,
    InIdle,
    InArmed,
    InRunning,
}

/// Torques of a run, as bits; `None` if the value makes the parameters inconsistent.
fn torques(
    client: &mut Client,
    it: &Parameter,
    value: ParameterValue,
    when: Set,
) -> Result<Option<Vec<u32>>, Failure> {
    client.reset()?;
    client.idle()?;
    client.long_watchdog()?;
    let law =
        client.description.laws.iter().find(|law| it.laws.contains(law.index)).map_or(0, |law| law.index);
    if it.name != CONTROLLER && client.parameter(CONTROLLER).is_ok() {
        client.put(CONTROLLER, ParameterValue::U32(law.into()))?;
    }
    let index = it.index;
    if when == Set::InIdle {
        client.put(&it.name, value)?;
    }
    let session = client.session;
    let answers = client.request(Arm { session })?;
    if outcome::<Arm>(&answers)? == Outcome::Inconsistent {
        return Ok(None);
    }
    if when == Set::InArmed {
        client.request(SetParameter { index, value })?;
    }
    client.start()?;
    let mut torques = Vec::new();
    for sequence in 0..STEPS {
        let reference_rad = 0.5 + 0.125 * f32::from(sequence);
        let answers = client.request(EncoderSample { reference_rad, ..sample(sequence) })?;
        torques.push(torque(&answers)?.torque_nm.to_bits());
        if when == Set::InRunning && sequence == BEFORE {
            client.request(SetParameter { index, value })?;
        }
    }
    Ok(Some(torques))
}

/// The live parameters that may be changed at will, each with another value.
fn live(client: &Client) -> Result<Vec<(Parameter, ParameterValue)>, Failure> {
    let live = client.description.parameters.iter().filter(|it| it.live && it.name != WATCHDOG_US);
    let with_value = live.map(|it| {
        let middle = within(it, 0.5);
        (it.clone(), if middle == it.default { neighbour(it) } else { middle })
    });
    let found: Vec<_> = with_value.collect();
    if found.is_empty() { skip("the drive has no live parameter besides reserved ones") } else { Ok(found) }
}

fn live_in_armed(client: &mut Client) -> RuleResult {
    for (it, value) in live(client)? {
        let Some(wanted) = torques(client, &it, value, Set::InIdle)? else { continue };
        let got = torques(client, &it, value, Set::InArmed)?;
        let what = format!("{} = {value} set in Armed: torques, as bits, as if set in Idle,", it.name);
        equal(&what, Some(wanted), got)?;
    }
    Ok(())
}

fn live_in_running(client: &mut Client) -> RuleResult {
    for (it, value) in live(client)? {
        if REQUIRED.contains(&&*it.name) {
            // The limits of a run are those in force at its start.
            continue;
        }
        let runs = [Set::Never, Set::InIdle, Set::InRunning].map(|when| torques(client, &it, value, when));
        let [never, first, later] = runs;
        let (Some(never), Some(first), Some(later)) = (never?, first?, later?) else { continue };
        let (before, after) = later.split_at(usize::from(BEFORE) + 1);
        let (never_before, never_after) = never.split_at(before.len());
        let name = &it.name;
        equal(&format!("torques before {name} was set, as bits,"), never_before.to_vec(), before.to_vec())?;
        // A value with an effect on the first torque has one on a later torque too.
        if first[0] != never[0] {
            let what = format!("other torques after {name} = {value} was set in Running");
            expect(after != never_after, what, "the torques of the default")?;
        }
    }
    Ok(())
}
