//! Laws, signals and choices, as the drive describes them.

use std::collections::HashSet;
use std::fmt::Display;

use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::limits::{MAX_LAWS, MAX_SIGNALS};
use lashloop_protocol::message::{DescribeChoice, DescribeLaw, DescribeSignal};

use lashloop_bench::session::{Description, LawMask};

use super::answers::outcome;
use super::assertion::{RuleResult, equal, expect};
use super::check::{Check, check};
use super::client::{CONTROLLER, Client};

pub(super) fn checks() -> Vec<Check> {
    let mut checks = vec![
        check("R10", "the drive has 1 to 16 laws and at most 32 signals", |client| {
            let (laws, signals) = (client.identity.law_count, client.identity.signal_count);
            expect((1..=MAX_LAWS).contains(&usize::from(laws)), "1 to 16 laws", laws)?;
            expect(usize::from(signals) <= MAX_SIGNALS, "at most 32 signals", signals)
        }),
        check("R10", "names of laws, signals and choices are unique and not empty", |client| {
            let it = &client.description;
            unique("law", it.laws.iter().map(|law| &law.name))?;
            unique("signal", it.signals.iter().map(|signal| &signal.signal.name))?;
            it.parameters.iter().try_for_each(|parameter| {
                unique(&format!("choice of {}", parameter.name), parameter.choices.iter().map(|it| &it.name))
            })
        }),
        check("R10", "every parameter and every signal belongs to a law", |client| {
            let laws = u32::from(client.identity.law_count);
            let belongs = |name: &str, mask: LawMask| {
                let known = (1_u32 << laws) - 1;
                expect(u32::from(mask.0) & known != 0, format!("{name} in one of the laws"), mask.0)
            };
            let it = &client.description;
            it.parameters.iter().try_for_each(|parameter| belongs(&parameter.name, parameter.laws))?;
            it.signals.iter().try_for_each(|signal| belongs(&signal.signal.name, signal.laws))
        }),
        check("R10", "controller has the names of the laws as choices", controller),
        check("R10", "an unknown law, signal or choice is answered with UnknownIndex", unknown_index),
    ];
    for state in [State::Boot, State::Idle, State::Armed, State::Running, State::Faulted] {
        let name = format!("the drive describes itself in {state:?} as at the start");
        checks.push(check("R10", name, move |client| {
            client.enter(state)?;
            let again = Description::read(&mut client.line, &client.identity)?;
            expect(again == client.description, "the description read first", "another one")
        }));
    }
    checks
}

fn unique<'a, T: AsRef<str> + Display + 'a>(what: &str, names: impl Iterator<Item = &'a T>) -> RuleResult {
    let mut seen = HashSet::new();
    for name in names {
        let is_new = !name.as_ref().is_empty() && seen.insert(name.as_ref().to_owned());
        expect(is_new, format!("a {what} with a name that no other has"), name.as_ref())?;
    }
    Ok(())
}

/// A drive with one law may omit the parameter.
fn controller(client: &mut Client) -> RuleResult {
    let laws: Vec<_> = client.description.laws.iter().map(|law| law.name.clone()).collect();
    if laws.len() == 1 && client.parameter(CONTROLLER).is_err() {
        return Ok(());
    }
    let it = client.parameter(CONTROLLER)?;
    expect(!it.live, "controller without LIVE", it.live)?;
    let range = (ParameterValue::U32(0), ParameterValue::U32((laws.len() as u32).saturating_sub(1)));
    equal("min and max of controller", range, (it.min, it.max))?;
    let choices: Vec<_> = it.choices.iter().map(|choice| choice.name.clone()).collect();
    equal("choices of controller", laws, choices)
}

fn unknown_index(client: &mut Client) -> RuleResult {
    client.idle()?;
    let (laws, signals) = (client.identity.law_count, client.identity.signal_count);
    for index in [laws, u8::MAX] {
        let answers = client.request(DescribeLaw { index })?;
        equal(&format!("to law {index}"), Outcome::UnknownIndex, outcome::<DescribeLaw>(&answers)?)?;
    }
    for index in [signals, u8::MAX] {
        let answers = client.request(DescribeSignal { index })?;
        equal(&format!("to signal {index}"), Outcome::UnknownIndex, outcome::<DescribeSignal>(&answers)?)?;
    }
    let mut unknown = vec![(client.identity.parameter_count, 0), (u8::MAX, 0)];
    for it in &client.description.parameters {
        match it.max {
            ParameterValue::U32(max) if !it.choices.is_empty() => {
                let above = max.checked_add(1).and_then(|choice| u8::try_from(choice).ok());
                unknown.extend(above.map(|choice| (it.index, choice)));
            }
            _ => unknown.push((it.index, 0)),
        }
    }
    unknown.into_iter().try_for_each(|(parameter, choice)| {
        let answers = client.request(DescribeChoice { parameter, choice })?;
        let what = format!("to choice {choice} of parameter {parameter}");
        equal(&what, Outcome::UnknownIndex, outcome::<DescribeChoice>(&answers)?)
    })
}
