//! How long encoders may go unread, and encoders that may not at all.

use lashloop_protocol::message::Arm;
use lashloop_protocol::vocabulary::{Outcome, ParameterValue, State, TorqueFlags};

use super::{BOTH, Encoder, LOAD, LONGEST_GAP, MOTOR, allowed, encoders, running, speed_per_count_rad_s};
use crate::conformance::check::{Check, Checked, Failure, equal, names};
use crate::conformance::client::{Client, outcome, torque};
use crate::conformance::samples::stray;

/// What most encoders of servo drives have: the limits that go with the gaps tried here are those of real machines.
const GAP_COUNTS_PER_REV: u32 = 131_072;
/// Counts that a difference of readings tells apart either way, without the one that an encoder may show too much.
const COUNTS_TOLD_APART: f64 = ((1 << 23) - 2) as f64;

pub(super) fn checks() -> Vec<Check> {
    let told = "a gap is taken as long as positions can be told apart, and no longer";
    let mut checks = vec![Check::new("encoders", told, |client| {
        // Periods that the encoders of motor and load allow.
        [(400, 800), (800, 400), (5_000, 5_000)]
            .into_iter()
            .try_for_each(|(motor, load)| longest_gap(client, motor, load))
    })];
    checks.extend(BOTH.into_iter().map(|encoder| {
        let name = format!("Arm is refused if no period tells positions of the {} apart", encoder.name);
        Check::new("encoders", name, move |client| never_told_apart(client, encoder))
    }));
    checks
}

/// The speed limit in rad/s with which positions can be told apart over so many periods.
fn limit_rad_s(counts_per_rev: u32, periods: f64) -> f32 {
    let counts_per_period = COUNTS_TOLD_APART / periods;
    (counts_per_period * speed_per_count_rad_s(counts_per_rev)) as f32
}

/// Tries the longest gap of encoders that allow so many periods.
fn longest_gap(client: &mut Client, motor: u16, load: u16) -> Checked {
    // Half a period more, so that no rounding in the drive counts.
    let [motor_rad_s, load_rad_s] =
        [motor, load].map(|periods| limit_rad_s(GAP_COUNTS_PER_REV, f64::from(periods) + 0.5));
    client.fresh()?;
    running(client, &encoders(GAP_COUNTS_PER_REV, motor_rad_s, load_rad_s))?;
    client.torque(0)?;
    let longest = motor.min(load).min(LONGEST_GAP);
    stray(client, longest + 1)?;
    let answer = torque(&client.sample(longest)?)?;
    let what = format!("{motor_rad_s} and {load_rad_s} rad/s, {longest} periods on: sequence, state, flags");
    let flags = answer.status.flags - TorqueFlags::SATURATED;
    let wanted = (longest, State::Running, TorqueFlags::GAP);
    equal(&what, wanted, (answer.sequence, answer.status.state, flags))
}

/// Arms with the finest encoder the drive takes, and a speed limit a little too high for it and a little lower.
fn never_told_apart(client: &mut Client, encoder: Encoder) -> Checked {
    const SLOW_RAD_S: f32 = 10.0;
    // Of one resolution, because laws may refuse resolutions that are too far apart.
    let counts_per_rev = finest(client, MOTOR)?.min(finest(client, LOAD)?);
    let (high_rad_s, low_rad_s) = (limit_rad_s(counts_per_rev, 0.75), limit_rad_s(counts_per_rev, 1.5));
    let slow = encoders(counts_per_rev, SLOW_RAD_S, SLOW_RAD_S);
    let [high, low] = [high_rad_s, low_rad_s].map(|rad_s| (encoder.speed_limit, ParameterValue::F32(rad_s)));
    allowed(client, &[&slow[..], &[high, low]].concat())?;
    client.idle()?;
    for (name, value) in slow.into_iter().chain([high]) {
        client.put(name, value)?;
    }
    let session = client.session();
    let answers = client.say(Arm { session })?;
    let mut came = names(&answers);
    // Why may take more than one line.
    came.dedup();
    let what = format!("{} = {high_rad_s} at {counts_per_rev} counts/rev:", encoder.speed_limit);
    equal(&format!("{what} answers"), vec!["Log", "CommandResult"], came)?;
    let came = (outcome::<Arm>(&answers)?, client.state());
    equal(&format!("{what} outcome and state"), (Outcome::Inconsistent, State::Idle), came)?;
    client.put(low.0, low.1)?;
    client.arm()
}

/// The finest encoder that the drive takes, in counts per revolution.
fn finest(client: &Client, encoder: Encoder) -> Result<u32, Failure> {
    match client.parameter(encoder.counts_per_rev)?.max {
        ParameterValue::U32(max) => Ok(max),
        ParameterValue::F32(max) => Err(Failure::Rule {
            expected: format!("a whole number as the largest {}", encoder.counts_per_rev),
            came: format!("the real number {max}"),
        }),
    }
}
