//! The values of telemetry: one for each signal, in order, of the sample itself.

use super::subscription::{accepted, running_with, signals};
use crate::prelude::checks::*;

/// Samples of a run.
const STEPS: u16 = 5;
/// Runs of a check that fails.
const ATTEMPTS: u32 = 3;
/// References of a run. The mechanics stay at rest: a coarse encoder would exceed its speed limit.
const REFERENCES_RAD: [f32; STEPS as usize] = [1.0, 0.75, -0.5, 0.25, -1.25];

pub(super) fn checks() -> Vec<Check> {
    vec![
        check(
            "R4.12 R11.4",
            "values are those of the subscribed signals, in the order of their indices",
            |client| firmly(client, order_of_values),
        ),
        check("R11.4", "values are of the control step of their sample", |client| {
            firmly(client, of_the_sample)
        }),
        check("R10.15 R11.4", "telemetry carries the requested torque before the limit", requested_torque),
    ]
}

/// Makes a check that compares the values of runs. A signal need not be a function of the samples, as a clock is not, so a
/// difference counts only if it occurs every time alike.
fn firmly(client: &mut Client, check: fn(&mut Client) -> RuleResult) -> RuleResult {
    let mut first = None;
    for _ in 0..ATTEMPTS {
        match check(client) {
            Err(Failure::Rule { expected, got }) => {
                let failure = (expected, got);
                if *first.get_or_insert_with(|| failure.clone()) != failure {
                    return Ok(());
                }
            }
            ended => return ended,
        }
        client.reset()?;
    }
    first.map_or(Ok(()), |(expected, got)| Err(broken(expected, got)))
}

/// The values of a run's telemetry as bits, one list a sample; none without telemetry.
fn series(
    client: &mut Client,
    signals: u32,
    every: u16,
    references_rad: &[f32],
) -> Result<Vec<Vec<u32>>, Failure> {
    running_with(client, signals, every)?;
    let mut series = Vec::new();
    for (sequence, &reference_rad) in (0..).zip(references_rad) {
        let last = if sequence % every == 0 { "Telemetry" } else { "TorqueAnswer" };
        let answers = client.request_to(EncoderSample { reference_rad, ..sample(sequence) }, last)?;
        if sequence % every != 0 {
            series.push(Vec::new());
            continue;
        }
        let telemetry = telemetry(&answers)?;
        let values: Vec<_> = telemetry.values.as_slice().iter().map(|value| value.to_bits()).collect();
        equal("number of values", signals.count_ones() as usize, values.len())?;
        series.push(values);
    }
    client.request(Stop {})?;
    Ok(series)
}

fn numbers(values: &[u32]) -> Vec<Bits> {
    values.iter().copied().map(Bits).collect()
}

/// Each signal alone and all together, on the same samples.
fn order_of_values(client: &mut Client) -> RuleResult {
    let all = signals(client)?;
    let indices: Vec<_> = (0..32_u8).filter(|index| all & 1 << index != 0).collect();
    let mut alone = Vec::new();
    for index in &indices {
        alone.push(series(client, 1 << index, 1, &REFERENCES_RAD)?);
    }
    let together = series(client, all, 1, &REFERENCES_RAD)?;
    for step in 0..usize::from(STEPS) {
        let wanted: Vec<_> = alone.iter().flat_map(|series| series[step].clone()).collect();
        let got = together[step].clone();
        if let Some(at) = wanted.iter().zip(&got).position(|(wanted, got)| wanted != got) {
            let [wanted, got] = [wanted[at], got[at]].map(|bits| Bits(bits).words());
            let signal = indices[at];
            return Err(broken(
                format!("in sample {step} for signal {signal}, as in its own telemetry, {wanted}"),
                got,
            ));
        }
    }
    Ok(())
}

fn of_the_sample(client: &mut Client) -> RuleResult {
    let all = signals(client)?;
    let every_sample = series(client, all, 1, &REFERENCES_RAD)?;
    // Telemetry of fewer samples has the values of these samples, not of the last one with telemetry.
    let every_second = series(client, all, 2, &REFERENCES_RAD)?;
    for step in (0..usize::from(STEPS)).step_by(2) {
        let [wanted, got] = [&every_sample, &every_second].map(|series| series[step].clone());
        equal(
            &format!("values of sample {step} with every = 2, as with every = 1:"),
            numbers(&wanted),
            numbers(&got),
        )?;
    }
    // A run starts from the initial state: its first values are not those of the run before.
    let mut references_rad = REFERENCES_RAD;
    references_rad[1] = 2.5;
    let changed = series(client, all, 1, &references_rad)?;
    equal("values of sample 0 of another run:", numbers(&every_sample[0]), numbers(&changed[0]))?;
    // With another reference in sample 1, several signals that differ in sample 2, but none in sample 1, are late.
    let differing =
        |step: usize| every_sample[step].iter().zip(&changed[step]).filter(|(one, two)| one != two).count();
    if differing(1) == 0 && differing(2) > 1 {
        return Err(broken(
            "in sample 1 other values with another reference in this sample",
            format!("none; in sample 2 {} other values", differing(2)),
        ));
    }
    Ok(())
}

fn requested_torque(client: &mut Client) -> RuleResult {
    let Some(index) = client.requested_torque() else {
        return skip("the drive has no signal requested_torque_nm");
    };
    client.idle()?;
    accepted(client, 1 << index, 1)?;
    client.running(&[])?;
    let limit_nm = client.real("torque_limit_nm")?;
    let mut first = None;
    (0..).zip(REFERENCES_RAD).try_for_each(|(sequence, reference_rad)| {
        let answers = client.request(EncoderSample { reference_rad, ..sample(sequence) })?;
        let wanted_nm = telemetry(&answers)?.values.as_slice()[0].clamp(-limit_nm, limit_nm);
        first.get_or_insert(wanted_nm);
        let what = "torque, of that in the telemetry within the limit,";
        equal(what, wanted_nm, torque(&answers)?.torque_nm)
    })?;
    let Some(free_nm) = first else { return Ok(()) };
    client.request(Stop {})?;
    client.running_if_consistent(&[("torque_limit_nm", F32(free_nm.abs() / 4.0))])?;
    let reference_rad = REFERENCES_RAD[0];
    let answers = client.request(EncoderSample { reference_rad, ..sample(0) })?;
    // A law that knows the limit may keep within it.
    let (it, requested_nm) = (torque(&answers)?, telemetry(&answers)?.values.as_slice()[0]);
    let is_more =
        requested_nm.abs() > it.torque_nm.abs() || !it.status.flags.contains(TorqueFlags::SATURATED);
    let expected = format!("in the telemetry of a limited torque more than its {} N m", it.torque_nm);
    expect(is_more, expected, requested_nm)
}
