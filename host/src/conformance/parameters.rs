//! Parameters: descriptions, ranges, refusals and read-back.

use std::collections::HashSet;

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{DescribeParameter, GetParameter, SetParameter};
use lashloop_protocol::parameter_names::REQUIRED;

use lashloop_bench::session::Parameter;

use super::answers::report;
use super::assertion::{RuleResult, equal, expect, find};
use super::check::{Check, check};
use super::client::Client;
use super::range::{holds, nearest_whole, outside};

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R9", "the drive has every required parameter", |client| {
            REQUIRED.iter().try_for_each(|name| client.parameter(name).map(drop))
        }),
        check("R9", "every parameter name is unique", |client| {
            let mut seen = HashSet::new();
            client.description.parameters.iter().try_for_each(|it| {
                expect(!it.name.is_empty() && seen.insert(&it.name), "a name no other has", &it.name)
            })
        }),
        check("R9", "default, minimum and maximum have one type", |client| {
            client.description.parameters.iter().try_for_each(|it| {
                let types = (it.default.ty(), it.min.ty(), it.max.ty());
                expect(types.0 == types.1 && types.1 == types.2, format!("{}: one type", it.name), types)
            })
        }),
        check("R9", "every default lies in its range", |client| {
            client.description.parameters.iter().try_for_each(|it| {
                expect(
                    holds(it, it.default),
                    format!("{} within {} to {}", it.name, it.min, it.max),
                    it.default,
                )
            })
        }),
        check("R9", "after a reset every parameter has its default", |client| {
            client.idle()?;
            each(client, |client, it| in_force(client, it, it.default))
        }),
        check("R9", "every parameter accepts its minimum and maximum and reads them back", |client| {
            client.idle()?;
            each(client, |client, it| {
                for value in [it.min, it.max, it.default] {
                    let got = client.set(it.index, value)?;
                    let what = format!("{} set to {value}:", it.name);
                    equal(&what, (Outcome::Accepted, value), (got.outcome, got.value))?;
                    in_force(client, it, value)?;
                }
                Ok(())
            })
        }),
        check("R9", "a value out of range is refused and changes nothing", |client| {
            client.idle()?;
            each(client, |client, it| {
                outside(it).into_iter().try_for_each(|value| refused(client, it, value, Outcome::OutOfRange))
            })
        }),
        check("R9", "a value of the wrong type is refused and changes nothing", |client| {
            client.idle()?;
            each(client, |client, it| {
                let value = match it.default {
                    ParameterValue::U32(value) => ParameterValue::F32(value as f32),
                    ParameterValue::F32(value) => ParameterValue::U32(value as u32),
                };
                refused(client, it, value, Outcome::WrongType)
            })
        }),
        check("R9", "an unknown parameter index is refused", unknown_index),
        check("R9", "a reset restores the default of a changed parameter", |client| {
            client.idle()?;
            let it = client.parameter("torque_limit_nm")?.clone();
            client.put(&it.name, it.min)?;
            client.reset()?;
            in_force(client, &it, it.default)
        }),
        check("R9", "the identity follows the period and encoder parameters", identity_follows),
        check("R9", "while running a live parameter is accepted and any other refused", |client| {
            client.running(&[])?;
            // This check has already changed the watchdog.
            let watchdog = client.parameter("watchdog_us")?.index;
            each(client, |client, it| {
                if it.index == watchdog {
                    return Ok(());
                }
                let outcome = if it.live { Outcome::Accepted } else { Outcome::WrongState };
                let got = client.set(it.index, it.default)?;
                let what = format!("{} with live = {}:", it.name, it.live);
                equal(&what, (outcome, State::Running), (got.outcome, got.state))
            })
        }),
    ];
    for state in [State::Boot, State::Faulted] {
        checks.push(check("R9", format!("in {state:?} nothing can be set"), move |client| {
            client.enter(state)?;
            each(client, |client, it| {
                let got = client.set(it.index, it.default)?;
                equal(&it.name, (Outcome::WrongState, state), (got.outcome, got.state))
            })
        }));
    }
    checks
}

fn each(client: &mut Client, mut check: impl FnMut(&mut Client, &Parameter) -> RuleResult) -> RuleResult {
    client.description.parameters.to_vec().iter().try_for_each(|parameter| check(client, parameter))
}

fn in_force(client: &mut Client, parameter: &Parameter, value: ParameterValue) -> RuleResult {
    let got = client.get(parameter.index)?;
    let what = format!("{} read back:", parameter.name);
    equal(&what, (Outcome::Accepted, value), (got.outcome, got.value))
}

fn refused(
    client: &mut Client,
    parameter: &Parameter,
    value: ParameterValue,
    outcome: Outcome,
) -> RuleResult {
    let got = client.set(parameter.index, value)?;
    let what = format!("{} set to {value}:", parameter.name);
    equal(&what, (outcome, parameter.default), (got.outcome, got.value))?;
    in_force(client, parameter, parameter.default)
}

fn unknown_index(client: &mut Client) -> RuleResult {
    client.idle()?;
    let index = client.identity.parameter_count;
    let value = ParameterValue::U32(0);
    for (what, answers) in [
        ("DescribeParameter", client.request(DescribeParameter { index })?),
        ("GetParameter", client.request(GetParameter { index })?),
        ("SetParameter", client.request(SetParameter { index, value })?),
    ] {
        equal(&format!("{what} {index}:"), Outcome::UnknownIndex, report(index, &answers)?.outcome)?;
    }
    // The last parameter is described under its own index.
    let Some(last) = index.checked_sub(1) else { return Ok(()) };
    let answers = client.request(DescribeParameter { index: last })?;
    find(&format!("a ParameterDescription for index {last}"), &answers, |answer| match answer {
        DriveMessage::ParameterDescription(it) if it.index == last => Some(()),
        _ => None,
    })
}

fn identity_follows(client: &mut Client) -> RuleResult {
    client.idle()?;
    let wished = [("period_us", 2_000), ("motor_counts_per_rev", 4_096), ("load_counts_per_rev", 8_192)];
    let mut wanted = [0; 3];
    for (wanted, (name, wished)) in wanted.iter_mut().zip(wished) {
        *wanted = nearest_whole(client.parameter(name)?, wished)?;
        client.put(name, ParameterValue::U32(*wanted))?;
    }
    let it = client.handshake(client.session)?;
    let got = [it.period_us, it.motor_counts_per_rev, it.load_counts_per_rev];
    equal("period and counts per revolution of motor and load", wanted, got)
}
