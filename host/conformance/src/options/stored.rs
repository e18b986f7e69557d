//! Stored parameters. A check leaves the set that it found, as far as a host can see.

use super::super::parameters::values::{defaults, in_force, set_all};
use super::offered::needs;
use crate::prelude::checks::*;

const LACKED: &str = "the drive stores no parameters";

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R20.2", "parameters are stored, recalled and forgotten in Idle alone", |client| {
            needs(client, Capabilities::STORE, LACKED)?;
            client.in_states(&[Boot, Armed, Running, Faulted], |client, state| {
                let refused = [
                    result(StoreParameters {}, WrongState, state),
                    result(RecallParameters {}, WrongState, state),
                    result(ForgetParameters {}, WrongState, state),
                ];
                client.exchange(&format!("in {state}"), &refused)
            })
        }),
        check(
            "R10.9 R20.3 R20.4 R20.5",
            "stored parameters are the defaults, after a reset too, until they are forgotten",
            |client| {
                needs(client, Capabilities::STORE, LACKED)?;
                let found = defaults(client);
                client.idle()?;
                // As they are: where nothing can be stored, nothing is lost.
                if outcome::<StoreParameters>(&client.request(StoreParameters {})?)? == Outcome::StoreFailed {
                    return skip("not run: the drive can't write its memory");
                }
                let kept = stored(client, &found);
                let left = leave(client, &found);
                if left.is_err() {
                    client.note = "warning: the drive has lost the parameters that it had stored".to_owned();
                }
                kept.and(left)
            },
        ),
    ]
}

fn stored(client: &mut Client, found: &[ParameterValue]) -> RuleResult {
    let mut changed: Vec<_> = client.description.parameters.iter().map(neighbour).collect();
    if let Some(it) = client.description.parameters.iter().find(|it| it.name == SAMPLE_SOURCE) {
        changed[usize::from(it.index)] = it.default;
    }
    set_all(client, &changed, false)?;
    client.exchange("in Idle", &[result(StoreParameters {}, Accepted, Idle)])?;
    in_force(client, "after StoreParameters", &changed, Idle)?;
    equal("defaults after StoreParameters:", &changed, &described(client)?)?;
    set_all(client, found, false)?;
    client.reset()?;
    in_force(client, "after StoreParameters and Reset", &changed, Boot)?;
    client.idle()?;
    set_all(client, found, false)?;
    client.exchange("in Idle", &[result(RecallParameters {}, Accepted, Idle)])?;
    in_force(client, "after RecallParameters", &changed, Idle)?;
    client.exchange("in Idle", &[result(ForgetParameters {}, Accepted, Idle)])?;
    let own = described(client)?;
    expect(own != changed, "after ForgetParameters other defaults than those stored", &own)?;
    in_force(client, "after ForgetParameters", &own, Idle)?;
    client.reset()?;
    in_force(client, "after ForgetParameters and Reset", &own, Boot)
}

/// Leaves nothing stored, if that gives the defaults that were found, else those.
fn leave(client: &mut Client, found: &[ParameterValue]) -> RuleResult {
    client.reset()?;
    client.idle()?;
    client.exchange("at the end", &[result(ForgetParameters {}, Accepted, Idle)])?;
    if described(client)? == found {
        return Ok(());
    }
    set_all(client, found, false)?;
    client.exchange("at the end", &[result(StoreParameters {}, Accepted, Idle)])?;
    equal("defaults at the end:", found, &*described(client)?)
}

/// The default of every parameter, as the drive describes it now.
fn described(client: &mut Client) -> Result<Vec<ParameterValue>, Failure> {
    let requests =
        client.description.parameters.iter().map(|it| DescribeParameter { index: it.index }.into());
    let answers = client.answers(&requests.collect::<Vec<_>>())?;
    let of_answer = |answer| find("a ParameterDescription", std::slice::from_ref(answer), of);
    let defaults = answers.iter().map(|answer| of_answer(answer).map(|it: ParameterDescription| it.default));
    defaults.collect()
}
