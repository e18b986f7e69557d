//! Samples: torque answers and sequence rules.

mod other_states;
mod repeats;
pub(super) mod runs;
mod sequence;

use crate::prelude::checks::*;
use runs::{equal_torques, torques_of_a_run};

/// Tolerated error of the drive's clock, as a fraction.
const CLOCK_TOLERANCE: f64 = 0.1;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R7.2 R4.11 R10.4", "while running a sample gets a torque with its sequence", |client| {
            client.running(&[])?;
            for sequence in 0..3 {
                let answer = accepted(client, sample(sequence), NONE)?;
                let pushes = sequence > 0 || answer.torque_nm != 0.0;
                expect(pushes, "a torque in N m for a load 1 rad off its reference", answer.torque_nm)?;
            }
            Ok(())
        }),
        check("R7.17 R10.4", "every law that the drive describes returns a torque", every_law),
        check("R7.17", "a new start resets the controller: equal samples get equal torques", new_start),
        check("R7.18", "the compute time of a torque is at most the time that the host waited", compute_time),
    ];
    checks.extend(sequence::checks());
    checks.extend(repeats::checks());
    checks.extend(other_states::checks());
    checks
}

/// A run after each end of a run before it.
fn new_start(client: &mut Client) -> RuleResult {
    client.long_watchdog()?;
    let fresh = torques_of_a_run(client, |_, _| Ok(()))?;
    client.command(Stop {})?;
    equal_torques("after Stop", &fresh, &torques_of_a_run(client, |_, _| Ok(()))?)?;
    client.command(EmergencyStop {})?;
    client.command(ClearFault {})?;
    equal_torques("after a fault", &fresh, &torques_of_a_run(client, |_, _| Ok(()))?)?;
    client.request(hello(client.session ^ 1))?;
    client.idle()?;
    equal_torques("after a new session", &fresh, &torques_of_a_run(client, |_, _| Ok(()))?)
}

fn compute_time(client: &mut Client) -> RuleResult {
    client.running(&[])?;
    for sequence in 0..10 {
        if sequence == 5 {
            // The time since the sample before is another one.
            client.wait_for(Duration::from_millis(20), |_| None::<()>)?;
        }
        let sent = client.line.now();
        let answer = torque(&client.sample(sequence)?)?;
        let waited = client.line.now().saturating_duration_since(sent);
        let most = waited.mul_f64(1.0 + CLOCK_TOLERANCE) + Duration::from_micros(1);
        let computed = Duration::from_nanos(100) * u32::from(answer.compute_tenths_us);
        let expected = format!("compute time of sample {sequence} at most {} us", most.as_micros());
        expect(computed <= most, expected, format!("{} us", computed.as_micros()))?;
    }
    Ok(())
}

/// Two runs under each law.
fn every_law(client: &mut Client) -> RuleResult {
    for law in client.description.laws.clone() {
        client.reset()?;
        client.long_watchdog()?;
        client.put_law(law.index)?;
        let first = torques_of_a_run(client, |_, _| Ok(()))?;
        client.command(Stop {})?;
        let again = torques_of_a_run(client, |_, _| Ok(()))?;
        equal_torques(&format!("{} in a second run", law.name), &first, &again)?;
    }
    Ok(())
}
