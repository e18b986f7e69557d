//! Runs whose torques are compared.

use crate::prelude::checks::*;

/// Steps after which any controller state shows in the torque.
const STEPS: u16 = 20;

/// Starts a run with encoders that allow gaps. Returns the longest gap in periods.
pub(super) fn start_with_gaps(client: &mut Client) -> Result<u16, Failure> {
    let setup = Setup::coarse(client)?;
    setup.start(client)?;
    match setup.longest_gap() {
        0 | 1 => skip("not run: no encoder setting of this drive allows a gap"),
        gap => Ok(gap),
    }
}

/// A sample of a movement in which motor, load and reference change, slow enough for any speed limit.
fn moving(sequence: u16) -> EncoderSample {
    let place = i64::from(sequence);
    let [motor_counts, load_counts] = [-place, (place + 1) / 2].map(EncoderCounts::wrapping);
    let reference_rad = if sequence % 10 < 7 { 1.0 } else { -0.5 };
    EncoderSample { motor_counts, load_counts, reference_rad, ..sample(sequence) }
}

/// The torques of a run from `Armed`, as bits; `after_each` follows every sample.
pub(crate) fn torques_of_a_run(
    client: &mut Client,
    after_each: impl Fn(&mut Client, &EncoderSample) -> RuleResult,
) -> Result<Vec<u32>, Failure> {
    client.arm_and_start()?;
    let mut torques = Vec::new();
    for sequence in 0..STEPS {
        let sample = moving(sequence);
        torques.push(accepted(client, sample, NONE)?.torque_nm.to_bits());
        after_each(client, &sample)?;
    }
    Ok(torques)
}

/// The torques of two runs must be equal in every bit.
pub(crate) fn equal_torques(what: &str, wanted: &[u32], got: &[u32]) -> RuleResult {
    for (sequence, (wanted, got)) in wanted.iter().zip(got).enumerate() {
        let [wanted_nm, got_nm] = [*wanted, *got].map(f32::from_bits);
        expect(wanted == got, format!("{what}: at sample {sequence} the torque {wanted_nm} N m"), got_nm)?;
    }
    Ok(())
}
