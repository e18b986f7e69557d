//! What keeps the values of parameters, and what ends them.

use super::super::range::within;
use super::values::{defaults, in_force, set_all};
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R4.3 R4.5 R9.8", "after a reset every parameter has its default", |client| {
            let defaults = defaults(client);
            in_force(client, "after Reset", &defaults, Boot)?;
            client.idle()?;
            in_force(client, "after the handshake", &defaults, Idle)
        }),
        check("R9.4 R9.7", "each parameter keeps a value of its own", |client| {
            client.idle()?;
            // In both directions, so that no setting hides that it changed another parameter too.
            let (rising, falling) = (spread(client, 0), spread(client, 7));
            for (values, descending) in [(rising, false), (falling, true)] {
                set_all(client, &values, descending)?;
                let order = if descending { "descending" } else { "ascending" };
                in_force(client, &format!("after all were set in {order} order"), &values, Idle)?;
                // The drive may find them inconsistent, and its pins not ready.
                let session = client.session;
                client.request(Arm { session })?;
                client.request(Stop {})?;
                in_force(client, "after Arm and Stop", &values, Idle)?;
            }
            Ok(())
        }),
        check("R4.3 R6.8", "a reset restores the default of every parameter", |client| {
            client.idle()?;
            let changed = spread(client, 3);
            set_all(client, &changed, false)?;
            client.reset()?;
            let defaults = defaults(client);
            in_force(client, "after Reset", &defaults, Boot)
        }),
        check("R6.7 R6.8", "sessions, versions, faults and ClearFault keep every parameter", |client| {
            client.idle()?;
            let kept = spread(client, 5);
            set_all(client, &kept, false)?;
            client.request(hello(client.session))?;
            client.request(other(client.session ^ 1))?;
            in_force(client, "after Hello of the same session, and of another version", &kept, Idle)?;
            client.request(EmergencyStop {})?;
            client.handshake(client.session ^ 1)?;
            client.handshake(client.session ^ 2)?;
            in_force(client, "in new sessions in Faulted", &kept, Faulted)?;
            client.exchange("in Faulted", &[result(ClearFault {}, Accepted, Idle)])?;
            client.handshake(client.session ^ 1)?;
            client.handshake(client.session ^ 2)?;
            in_force(client, "in new sessions in Idle", &kept, Idle)
        }),
        check("R6.8 R9.6 R10.13", "a run keeps every parameter, and Idle accepts settings again", run),
    ]
}

/// A value for each parameter, spread over its range. Different numbers give different values.
fn spread(client: &Client, number: usize) -> Vec<ParameterValue> {
    let parameters = &client.description.parameters;
    let steps = parameters.len() + 9;
    let fraction = |place| (place + number + 1) as f64 / steps as f64;
    parameters.iter().enumerate().map(|(place, it)| within(it, fraction(place))).collect()
}

fn run(client: &mut Client) -> Result<(), Failure> {
    client.idle()?;
    // Near the defaults, which go together.
    let mut kept: Vec<_> = client.description.parameters.iter().map(neighbour).collect();
    client.long_watchdog()?;
    let watchdog = client.parameter(WATCHDOG_US)?.index;
    kept[usize::from(watchdog)] = client.get(watchdog)?.value;
    // With samples of its own the drive would refuse those of the bench.
    if let Some(it) = client.description.parameters.iter().find(|it| it.name == SAMPLE_SOURCE) {
        kept[usize::from(it.index)] = it.default;
    }
    set_all(client, &kept, false)?;
    let session = client.session;
    let answers = client.request(Arm { session })?;
    // The drive may find the changed values inconsistent.
    if outcome::<Arm>(&answers)? == Inconsistent {
        return in_force(client, "after a refused Arm", &kept, Idle);
    }
    in_force(client, "in Armed", &kept, Armed)?;
    client.exchange("in Armed", &[result(Start { session }, Accepted, Running)])?;
    client.torque(0)?;
    in_force(client, "in Running", &kept, Running)?;
    client.request(Stop {})?;
    in_force(client, "after Stop", &kept, Idle)?;
    let defaults = defaults(client);
    set_all(client, &defaults, false)?;
    in_force(client, "after Stop and new settings", &defaults, Idle)
}
