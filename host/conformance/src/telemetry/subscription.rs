//! Subscriptions, and the telemetry that must follow a torque.

use crate::prelude::checks::*;

pub(super) const TORQUE: &[&str] = &["TorqueAnswer"];
pub(super) const BOTH: &[&str] = &["TorqueAnswer", "Telemetry"];

/// The signals of the law in force, 13 at most.
///
/// # Errors
/// The law has none: the check is skipped.
pub(crate) fn signals(client: &Client) -> Result<u32, Failure> {
    let bits = law_signals(client, client.default_law());
    match bits.first() {
        None => skip("the law in force has no signal").map(|()| 0),
        Some(_) => Ok(bits.iter().take(MAX_TELEMETRY_VALUES).fold(0, |all, index| all | 1 << index)),
    }
}

/// The indices of the signals of a law.
pub(crate) fn law_signals(client: &Client, law: u8) -> Vec<u8> {
    let of_law = client.description.signals.iter().filter(|it| it.laws.contains(law));
    of_law.map(|it| it.index).collect()
}

pub(crate) fn accepted(client: &mut Client, signals: u32, every: u16) -> RuleResult {
    let state = client.state;
    client.exchange("before", &[result(Subscribe { signals, every }, Accepted, state)])
}

/// The signal of a subscription with the lowest index, alone.
pub(super) const fn lowest(signals: u32) -> u32 {
    signals & signals.wrapping_neg()
}

pub(super) fn running_with(client: &mut Client, signals: u32, every: u16) -> RuleResult {
    client.idle()?;
    accepted(client, signals, every)?;
    client.running(&[])
}

/// Requires answers of these kinds to a sample, and its sequence in the telemetry.
pub(super) fn follows(client: &mut Client, sequence: u16, kinds: &[&'static str]) -> RuleResult {
    let answers = client.request_to(sample(sequence), kinds.last().copied().unwrap_or_default())?;
    let answers = of_kinds(&format!("to sample {sequence}"), kinds, answers)?;
    let mut telemetry = answers.iter().filter_map(of::<Telemetry>);
    telemetry.try_for_each(|it| equal("sequence of the telemetry", sequence, it.sequence))
}

/// Requires telemetry of this many values with the torque of a sample.
pub(super) fn carries(client: &mut Client, sequence: u16, count: u32) -> RuleResult {
    let answers = client.request_to(sample(sequence), BOTH[BOTH.len() - 1])?;
    let answers = of_kinds(&format!("to sample {sequence}"), BOTH, answers)?;
    let values = telemetry(&answers)?.values.as_slice().len();
    equal(&format!("values in the telemetry of sample {sequence}:"), count as usize, values)
}
