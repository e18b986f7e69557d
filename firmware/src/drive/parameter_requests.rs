//! The requests for parameters: describe, get and set.

use lashloop_protocol::DriveMessage;
use lashloop_protocol::enums::{Outcome, ParameterValue, State};
use lashloop_protocol::message::{ParameterDescription, ParameterReport, SetParameter};
use lashloop_protocol::text::Text;

use super::parameters::{Entry, Parameters, TABLE};

pub(super) fn describe(index: u8, state: State) -> DriveMessage {
    let Some(entry) = entry(index) else { return unknown(index, state).into() };
    ParameterDescription {
        index,
        live: u8::from(entry.live),
        default: entry.default,
        min: entry.min,
        max: entry.max,
        name: Text::new(entry.name),
        unit: Text::new(entry.unit),
    }
    .into()
}

pub(super) fn get(index: u8, parameters: &Parameters, state: State) -> ParameterReport {
    let Some(entry) = entry(index) else { return unknown(index, state) };
    ParameterReport { index, outcome: Outcome::Accepted, value: entry.get(parameters), state }
}

/// The report carries the value in force, whether it was set or not.
pub(super) fn set(request: &SetParameter, parameters: &mut Parameters, state: State) -> ParameterReport {
    let Some(entry) = entry(request.index) else { return unknown(request.index, state) };
    let may_be_set = match state {
        State::Idle => true,
        State::Armed | State::Running => entry.live,
        State::Boot | State::Faulted => false,
    };
    let outcome = if may_be_set { entry.set(parameters, request.value) } else { Outcome::WrongState };
    ParameterReport { index: request.index, outcome, value: entry.get(parameters), state }
}

fn entry(index: u8) -> Option<&'static Entry> {
    TABLE.get(usize::from(index))
}

fn unknown(index: u8, state: State) -> ParameterReport {
    ParameterReport { index, outcome: Outcome::UnknownParameter, value: ParameterValue::U32(0), state }
}
