//! Settings that a drive refuses: range, type, index and state. None may change a value.

use super::super::exchanges::reported;
use super::super::range::{beyond, of_other_type, outside};
use super::values::{defaults, each, set_live};
use crate::prelude::checks::*;

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R6.3 R9.3 R9.7", "a value out of range is refused and changes nothing", |client| {
            refused(client, |it| outside(it).into_iter().map(|value| (value, OutOfRange)).collect())
        }),
        check("R6.3 R9.1 R9.7", "a value of the wrong type is refused and changes nothing", |client| {
            refused(client, |it| of_other_type(it).into_iter().map(|value| (value, WrongType)).collect())
        }),
        check("R4.6 R6.2 R6.4", "an unknown parameter index is refused in every state", |client| {
            client.in_states(State::ALL, unknown)
        }),
        check("R6.4", "the state of the drive is checked before type and range of a value", |client| {
            client.in_states(&[Boot, Armed, Running, Faulted], wrong_in)
        }),
    ];
    for state in [Armed, Running] {
        let name = format!("in {state:?} a live parameter is accepted and any other refused");
        let rules = "R6.2 R6.3 R9.5 R9.7 R9.8 R9.15";
        checks.push(check(rules, name, move |client| settable(client, state)));
    }
    for state in [Boot, Faulted] {
        let name = format!("in {state:?} nothing can be set");
        checks.push(check("R6.2 R6.3 R9.5 R9.7 R9.8", name, move |client| settable(client, state)));
    }
    checks
}

/// Sets every parameter to a value other than its default, so that the value in force is neither, and requires these
/// refusals without effect.
fn refused(client: &mut Client, values: impl Fn(&Parameter) -> Vec<(ParameterValue, Outcome)>) -> RuleResult {
    client.idle()?;
    each(client, |client, it| {
        let kept = neighbour(it);
        let mut exchanges = vec![sets(it.index, kept, Accepted, kept, Idle)];
        for (value, outcome) in values(it) {
            exchanges.push(sets(it.index, value, outcome, kept, Idle));
            exchanges.push(reads(it.index, kept, Idle));
        }
        client.exchange(&it.name, &exchanges)
    })
}

fn unknown(client: &mut Client, state: State) -> RuleResult {
    // 255 is the index that ends every exchange.
    for index in beyond(client, client.identity.parameter_count, u8::MAX - 1) {
        let report = reported(index, UnknownIndex, U32(0), state);
        let requests: [HostMessage; 4] = [
            DescribeParameter { index }.into(),
            GetParameter { index }.into(),
            SetParameter { index, value: U32(1) }.into(),
            SetParameter { index, value: F32(f32::NAN) }.into(),
        ];
        let exchanges: Vec<Exchange> = requests.into_iter().map(|it| (it, report.into())).collect();
        client.exchange(&format!("in {state:?}"), &exchanges)?;
    }
    Ok(())
}

/// Values in force after [`Client::enter`], which sets some of them.
fn present(client: &mut Client) -> Result<Vec<ParameterValue>, super::super::assertion::Failure> {
    let mut values = defaults(client);
    for name in [WATCHDOG_US, TORQUE_LIMIT_NM] {
        let index = client.parameter(name)?.index;
        values[usize::from(index)] = client.get(index)?.value;
    }
    Ok(values)
}

/// Wrong type and wrong range in a state that allows no setting at all.
fn wrong_in(client: &mut Client, state: State) -> RuleResult {
    let present = present(client)?;
    let mut exchanges = Vec::new();
    for it in client.description.parameters.iter().filter(|it| !it.live || matches!(state, Boot | Faulted)) {
        let kept = present[usize::from(it.index)];
        let wrong = of_other_type(it).into_iter().take(1).chain(outside(it).into_iter().take(1));
        exchanges.extend(wrong.map(|value| sets(it.index, value, WrongState, kept, state)));
    }
    client.exchange(&format!("in {state:?}"), &exchanges)
}

fn settable(client: &mut Client, state: State) -> RuleResult {
    client.enter(state)?;
    let present = present(client)?;
    let (mut exchanges, mut live) = (Vec::new(), Vec::new());
    for it in &client.description.parameters {
        let kept = present[usize::from(it.index)];
        let value = neighbour(it);
        if it.live && matches!(state, Armed | Running) {
            live.push((it.clone(), kept));
        } else {
            exchanges.push(sets(it.index, value, WrongState, kept, state));
            exchanges.push(reads(it.index, kept, state));
        }
    }
    client.exchange(&format!("in {state}"), &exchanges)?;
    let most = client.repetitions(live.len());
    for (it, kept) in live.into_iter().take(most) {
        for wished in [neighbour(&it), it.min, it.max, kept] {
            let in_force = set_live(client, &it, wished)?;
            // Type before range, for live ones too.
            let wrong_type = of_other_type(&it).into_iter().map(|wrong| (wrong, WrongType));
            let wrong = wrong_type.chain(outside(&it).into_iter().map(|wrong| (wrong, OutOfRange)));
            let refused = wrong.map(|(wrong, outcome)| sets(it.index, wrong, outcome, in_force, state));
            let exchanges: Vec<_> = refused.chain([reads(it.index, in_force, state)]).collect();
            client.exchange(&format!("in {state}"), &exchanges)?;
        }
    }
    Ok(())
}
