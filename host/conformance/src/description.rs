//! Laws, signals and choices, as the drive describes them.

use std::collections::HashSet;
use std::fmt::Display;

use lashloop_session::diagnosis::Cause;
use lashloop_session::{Description, LawMask};

use super::parameters::foreign_names;
use super::range::beyond;
use super::result::{CheckResult, CheckStatus};
use crate::prelude::checks::*;

pub(super) const GROUP: &str = "description";

/// Rules, name and expectation of the check of the description as a whole.
const DESCRIBED: (&str, &str, &str) = (
    "R9.8 R10.1 R10.6 R10.8",
    "the drive describes all that it announces",
    "possible counts and choices, and a description of each index",
);

/// The result of that check for a drive that has answered `Hello` and then sends nothing that answers a request of its
/// description; `None` for one that is silent, and for a line that damages frames.
pub(super) fn undescribed(error: &SessionError) -> Option<CheckResult> {
    let SessionError::Silent { waiting_for, limit, diagnosis, .. } = error else { return None };
    let is_of_drive = match &diagnosis.cause {
        Cause::Refused(_)
        | Cause::Flood
        | Cause::OtherNumber { .. }
        | Cause::OtherIndex(_)
        | Cause::PartAnswer { .. }
        | Cause::OtherAnswers
        | Cause::Crc(_)
        | Cause::Framing(_) => true,
        // The line, or another program on it.
        _ => false,
    };
    if *waiting_for == Hello::LAYOUT.name || !is_of_drive {
        return None;
    }
    let (rules, name, expected) = DESCRIBED;
    let status = CheckStatus::Failed { expected: expected.to_owned(), got: error.to_string() };
    let (name, note) = (name.to_owned(), String::new());
    Some(CheckResult { group: GROUP, rules, name, status, note, took: *limit })
}

pub(super) fn checks() -> Vec<Check> {
    vec![
        check("R10.1 R10.6", "the drive has 1 to 16 laws and at most 32 signals", |client| {
            let (laws, signals) = (client.identity.law_count, client.identity.signal_count);
            expect((1..=MAX_LAWS).contains(&usize::from(laws)), "1 to 16 laws", laws)?;
            expect(usize::from(signals) <= MAX_SIGNALS, "at most 32 signals", signals)
        }),
        check(DESCRIBED.0, DESCRIBED.1, |client| {
            let got = client.defects.join("; ");
            expect(client.defects.is_empty(), DESCRIBED.2, got)
        }),
        check("R10.1 R10.6 R10.8", "names of laws, signals and choices are unique and not empty", |client| {
            let it = &client.description;
            client.note = foreign_names(it.signals.iter().map(|it| &*it.signal.name));
            unique("law", it.laws.iter().map(|law| &law.name))?;
            unique("signal", it.signals.iter().map(|signal| &signal.signal.name))?;
            it.parameters.iter().try_for_each(|parameter| {
                unique(&format!("choice of {}", parameter.name), parameter.choices.iter().map(|it| &it.name))
            })
        }),
        check("R9.10 R10.7", "every parameter and every signal belongs to a law", |client| {
            // The mask of a description has the bits of the drive's laws only.
            let belongs =
                |name: &str, mask: LawMask| expect(mask.0 != 0, format!("{name} in one of the laws"), mask.0);
            let it = &client.description;
            it.parameters.iter().try_for_each(|parameter| belongs(&parameter.name, parameter.laws))?;
            it.signals.iter().try_for_each(|signal| belongs(&signal.signal.name, signal.laws))
        }),
        check("R10.3", "controller has the names of the laws as choices", controller),
        check("R10.8", "a parameter with choices is a U32 of at most 255", |client| {
            let with_choices = client.description.parameters.iter().filter(|it| !it.choices.is_empty());
            with_choices.into_iter().try_for_each(|it| {
                equal(&format!("{}: type", it.name), ParameterType::U32, it.default.ty())?;
                let last = matches!(it.max, U32(0..=255));
                expect(last, format!("{}: max of at most 255", it.name), it.max)
            })
        }),
        check("R4.5 R4.8 R4.9 R4.10 R10.9", "the drive describes itself as at the start", |client| {
            client.has_time_to_describe()?;
            let (again, _) = Description::read_with_defects(&mut client.line, &client.identity)?;
            let same = again == client.description;
            expect(same, "the description read first", if same { "it" } else { "another one" })
        }),
        check(
            "R4.1 R6.2 R9.8 R10.9",
            "the drive describes itself alike in every state and in any order",
            in_every_state,
        ),
        check("R10.9", "no setting changes a description", with_other_settings),
        check(
            "R4.1 R4.7 R6.2 R10.10",
            "an unknown law, signal or choice is answered with UnknownIndex in every state",
            |client| client.in_states(State::ALL, unknown_in),
        ),
    ]
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
    if laws.len() == 1 && !client.description.parameters.iter().any(|it| it.name == CONTROLLER) {
        return Ok(());
    }
    let it = client.parameter(CONTROLLER)?;
    expect(!it.live, "controller without LIVE", it.live)?;
    let range = (U32(0), U32((laws.len() as u32).saturating_sub(1)));
    equal("min and max of controller", range, (it.min, it.max))?;
    let choices: Vec<_> = it.choices.iter().map(|choice| choice.name.clone()).collect();
    equal("choices of controller", laws, choices)
}

/// Values that every drive has: a state, an outcome, a fault, a flag, and a kind of each direction.
const OF_EVERY_DRIVE: [(u8, u8); 6] = [
    (STATE_NAMES, Idle.byte()),
    (OUTCOME_NAMES, Accepted.byte()),
    (FAULT_NAMES, FaultCode::EmergencyStop.byte()),
    (FLAG_NAMES, TorqueFlags::REPEATED.bits()),
    (KIND_NAMES, DescribeChoice::LAYOUT.kind),
    (KIND_NAMES, ChoiceDescription::LAYOUT.kind),
];

/// A request for each description.
fn requests(client: &Client) -> Vec<HostMessage> {
    let identity = &client.identity;
    let laws = (0..identity.law_count).map(|index| DescribeLaw { index }.into());
    let signals = (0..identity.signal_count).map(|index| DescribeSignal { index }.into());
    let parameters = (0..identity.parameter_count).map(|index| DescribeParameter { index }.into());
    let choices = client.description.parameters.iter().flat_map(|it| {
        it.choices
            .iter()
            .map(|choice| DescribeChoice { parameter: it.index, choice: choice.value as u8 }.into())
    });
    let own = OF_EVERY_DRIVE.map(|(parameter, choice)| DescribeChoice { parameter, choice }.into());
    laws.chain(signals).chain(parameters).chain(choices).chain(own).collect()
}

/// Each description with its request, which must have the same index.
fn described(client: &mut Client) -> Result<Vec<Exchange>, Failure> {
    let requests = requests(client);
    let answers = client.answers(&requests)?;
    for (request, answer) in requests.iter().zip(&answers) {
        let fits = match (request, answer) {
            (HostMessage::DescribeLaw(it), DriveMessage::LawDescription(got)) => it.index == got.index,
            (HostMessage::DescribeSignal(it), DriveMessage::SignalDescription(got)) => it.index == got.index,
            (HostMessage::DescribeParameter(it), DriveMessage::ParameterDescription(got)) => {
                it.index == got.index
            }
            (HostMessage::DescribeChoice(it), DriveMessage::ChoiceDescription(got)) => {
                (it.parameter, it.choice) == (got.parameter, got.choice)
            }
            _ => false,
        };
        if !fits {
            return Err(broken(format!("the description for {}", request.words()), answer.words()));
        }
    }
    Ok(requests.into_iter().zip(answers).collect())
}

fn in_every_state(client: &mut Client) -> RuleResult {
    let before = described(client)?;
    let mut reversed = before.clone();
    reversed.reverse();
    // The first reading is that of `Boot`.
    let count = client.repetitions(State::ALL.len() - 1);
    client.in_states(&State::ALL[State::ALL.len() - count..], |client, state| {
        // In turn, as the states are ordered.
        let order = if matches!(state, Idle | Running) { &before } else { &reversed };
        client.exchange(&format!("in {state:?}"), order)
    })
}

fn with_other_settings(client: &mut Client) -> RuleResult {
    let before = described(client)?;
    client.idle()?;
    let parameters: Vec<Parameter> = client.description.parameters.clone();
    for it in &parameters {
        client.put(&it.name, neighbour(it))?;
    }
    client.handshake(client.session ^ 1)?;
    client.exchange("after every parameter was set, in another session", &before)
}

fn unknown_in(client: &mut Client, state: State) -> RuleResult {
    let Identity { law_count, signal_count, parameter_count, .. } = client.identity;
    let outcome = UnknownIndex;
    let mut exchanges: Vec<Exchange> = Vec::new();
    let [laws, signals] = [law_count, signal_count].map(|count| beyond(client, count, u8::MAX));
    exchanges.extend(laws.into_iter().map(|index| result(DescribeLaw { index }, outcome, state)));
    exchanges.extend(signals.into_iter().map(|index| result(DescribeSignal { index }, outcome, state)));
    // From 251 on an index is that of a list.
    let parameters = beyond(client, parameter_count, KIND_NAMES - 1);
    let mut unknown: Vec<_> = parameters.into_iter().flat_map(|index| [(index, 0), (index, 1)]).collect();
    for it in &client.description.parameters {
        match (it.min, it.max) {
            (U32(min), U32(max)) if !it.choices.is_empty() => {
                let outside = [min.checked_sub(1), max.checked_add(1), (max < 255).then_some(255)];
                let outside = outside.into_iter().flatten().filter_map(|choice| u8::try_from(choice).ok());
                unknown.extend(outside.map(|choice| (it.index, choice)));
            }
            _ => unknown.extend((0..client.repetitions(2) as u8).map(|choice| (it.index, choice))),
        }
    }
    let choices = unknown
        .into_iter()
        .map(|(parameter, choice)| result(DescribeChoice { parameter, choice }, outcome, state));
    exchanges.extend(choices);
    client.exchange(&format!("in {state:?}"), &exchanges)
}
