//! The values of the drive's parameters, and the requests for them: describe, get and set.
//!
//! The values are 32-bit words in the order of the set's table; the index on the wire is the index in both.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterFlags, ParameterValue, State};
use lashloop_protocol::message::{ChoiceDescription, ParameterDescription, ParameterReport, SetParameter};
use lashloop_protocol::text::Text;

use crate::law::{DriveParameters, LawSet, Parameter, ParameterGroup, Words};

/// Indices of the drive's own parameters: every table begins with `controller`, then has these.
static OF_DRIVE: [u8; DriveParameters::TABLE.len()] = {
    let mut indices = [0; DriveParameters::TABLE.len()];
    let mut at = 0;
    while at < indices.len() {
        indices[at] = at as u8 + 1;
        at += 1;
    }
    indices
};

/// The values in force.
pub(super) struct Parameters<L: LawSet> {
    words: L::Words,
}

impl<L: LawSet> Default for Parameters<L> {
    fn default() -> Self {
        Self { words: L::DEFAULTS }
    }
}

impl<L: LawSet> Parameters<L> {
    pub(super) fn words(&self) -> &L::Words {
        &self.words
    }

    /// Index of the law in force: the value of the first parameter.
    pub(super) fn law(&self) -> u32 {
        self.words.as_ref().first().copied().unwrap_or_default()
    }

    /// The drive's own parameters.
    pub(super) fn drive(&self) -> DriveParameters {
        DriveParameters::read(&mut Words::new(self.words.as_ref(), &OF_DRIVE))
    }

    pub(super) fn get(&self, index: u8, state: State) -> ParameterReport {
        report(L::PARAMETERS, self.words.as_ref(), index, Outcome::Accepted, state)
    }

    /// Sets a value. The report carries the value in force, whether it was set or not.
    pub(super) fn set(&mut self, request: &SetParameter, state: State) -> ParameterReport {
        let outcome = match state {
            State::Idle => put(L::PARAMETERS, self.words.as_mut(), request),
            State::Boot | State::Armed | State::Running | State::Faulted => Outcome::WrongState,
        };
        report(L::PARAMETERS, self.words.as_ref(), request.index, outcome, state)
    }
}

// Functions over any table, so that the image holds each once.

fn put(table: &[Parameter], words: &mut [u32], request: &SetParameter) -> Outcome {
    let index = usize::from(request.index);
    let (Some(parameter), Some(word)) = (table.get(index), words.get_mut(index)) else {
        return Outcome::UnknownIndex;
    };
    match parameter.range.word(request.value) {
        Ok(value) => {
            *word = value;
            Outcome::Accepted
        }
        Err(outcome) => outcome,
    }
}

/// The value in force; zero and `UnknownIndex` if no parameter has this index.
fn report(table: &[Parameter], words: &[u32], index: u8, outcome: Outcome, state: State) -> ParameterReport {
    let at = usize::from(index);
    match (table.get(at), words.get(at)) {
        (Some(parameter), Some(word)) => {
            ParameterReport { index, outcome, value: parameter.range.value(*word), state }
        }
        _ => {
            let (outcome, value) = (Outcome::UnknownIndex, ParameterValue::U32(0));
            ParameterReport { index, outcome, value, state }
        }
    }
}

/// The description of a parameter.
pub(super) fn describe(table: &[Parameter], index: u8, state: State) -> DriveMessage {
    let Some(parameter) = table.get(usize::from(index)) else {
        return report(table, &[], index, Outcome::UnknownIndex, state).into();
    };
    let range = parameter.range;
    let flags = if range.choices().is_some() { ParameterFlags::CHOICES } else { ParameterFlags::empty() };
    ParameterDescription {
        index,
        flags,
        laws: parameter.laws,
        default: range.default(),
        min: range.min(),
        max: range.max(),
        name: Text::new(parameter.name),
        unit: Text::new(parameter.unit),
    }
    .into()
}

/// The name of a value; `None` if no parameter has this index, or no choice of it this value.
pub(super) fn describe_choice(table: &[Parameter], parameter: u8, choice: u8) -> Option<DriveMessage> {
    let names = table.get(usize::from(parameter))?.range.choices()?;
    let name = Text::new(names.get(usize::from(choice))?);
    Some(ChoiceDescription { parameter, choice, name }.into())
}
