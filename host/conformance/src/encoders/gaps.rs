//! Gaps between samples, up to the longest with an unambiguous position.

use lashloop_protocol::sequence::LONGEST_GAP;

use super::setup::{COARSE, UNAMBIGUOUS_COUNTS, Wish};
use crate::pins::{has, widest_duties};
use crate::prelude::checks::*;

/// Resolutions near that of a common servo encoder, so that the speed limits of these checks are those of real machines.
const GAP_COUNTS_PER_REV: [u32; 2] = [131_072, 100_000];

pub(super) fn checks() -> Vec<Check> {
    let name = "a gap is accepted up to the longest unambiguous one";
    let mut checks = vec![check("R7.9", name, |client| {
        // Longest unambiguous gap of the motor and of the load encoder, in periods.
        [(400, 800), (800, 400), (5_000, 5_000)]
            .into_iter()
            .try_for_each(|(motor, load)| longest_gap(client, motor, load))
    })];
    checks.extend(Encoder::BOTH.into_iter().map(|encoder| {
        let name =
            format!("Arm is refused if one period leaves the position of the {} ambiguous", encoder.name);
        check("R7.10", name, move |client| always_ambiguous(client, encoder))
    }));
    checks
}

/// Tries the longest gap with encoders that allow `motor` and `load` periods.
fn longest_gap(client: &mut Client, motor: u16, load: u16) -> RuleResult {
    let mut setup = Setup::of(client, &Wish { counts_per_rev: GAP_COUNTS_PER_REV, ..COARSE })?;
    for (scale, periods) in setup.scales.iter_mut().zip([motor, load]) {
        // Half a period more, so that rounding in the drive has no effect.
        scale.speed_limit_rad_s = scale.limit_rad_s(UNAMBIGUOUS_COUNTS / (f64::from(periods) + 0.5));
    }
    client.reset()?;
    setup.start(client)?;
    first_sample(client)?;
    let longest = motor.min(load).min(LONGEST_GAP);
    refused_sample(client, longest + 1)?;
    accepted(client, sample(longest), TorqueFlags::GAP)?;
    accepted(client, sample(longest + 1), NONE).map(drop)
}

/// Arms with the finest encoder of the drive, and with a speed limit just too high and then just low enough.
fn always_ambiguous(client: &mut Client, encoder: Encoder) -> RuleResult {
    // Equal resolutions if possible: a law may refuse resolutions that differ too much.
    let counts_per_rev = finest(client, Encoder::MOTOR)?.min(finest(client, Encoder::LOAD)?);
    let mut setup = Setup::of(client, &Wish { counts_per_rev: [counts_per_rev; 2], ..COARSE })?;
    let [(high, high_rad_s), (low, _)] = [0.9, 1.5].map(|periods| {
        let scale = &mut setup.scales[encoder.index];
        scale.speed_limit_rad_s = scale.limit_rad_s(UNAMBIGUOUS_COUNTS / periods);
        let limit_rad_s = scale.speed_limit_rad_s;
        (setup, limit_rad_s)
    });
    high.allowed(client)?;
    low.allowed(client)?;
    client.idle()?;
    client.put_all(&high.settings())?;
    let what = format!("{} = {high_rad_s} with the finest encoder:", encoder.speed_limit);
    refused_as_ambiguous(client, &[encoder], &what)?;
    if has(client, Capabilities::BENCH_MODE) {
        widest_duties(client)?;
        // Its inputs may be too slow for the other encoder too.
        refused_as_ambiguous(client, &Encoder::BOTH, &format!("in bench mode, {what}"))?;
        client.put(SAMPLE_SOURCE, U32(0))?;
    }
    client.put_all(&low.settings())?;
    client.arm()
}

fn refused_as_ambiguous(client: &mut Client, encoders: &[Encoder], what: &str) -> RuleResult {
    let answers = client.request(Arm { session: client.session })?;
    let answers = of_kinds(what, &["CommandResult"], answers)?;
    let it = command_result(&Arm::LAYOUT, &answers)?;
    let got = (it.outcome, it.state, client.state);
    equal(&format!("{what} outcome and state"), (Inconsistent, Idle, Idle), got)?;
    // Each of these could have another value, and the positions would be unambiguous.
    let of_encoders = encoders.iter().flat_map(|encoder| [encoder.speed_limit, encoder.counts_per_rev]);
    let names: Vec<_> = of_encoders.chain([PERIOD_US]).collect();
    let mut causes = names.iter().filter_map(|name| client.parameter(name).ok());
    let is_cause = causes.any(|cause| u32::from(cause.index) == it.detail);
    let names = names.join(", ");
    expect(is_cause, format!("{what} the index of one of {names} as detail"), it.detail)
}

/// The finest resolution of the drive, in counts per revolution.
fn finest(client: &Client, encoder: Encoder) -> Result<u32, Failure> {
    match client.parameter(encoder.counts_per_rev)?.max {
        U32(max) => Ok(max),
        // It represents the number exactly.
        F32(max) => Ok(max as u32),
        ParameterValue::Unknown { .. } => skip("not run: the resolution has a type of a newer drive"),
    }
}
