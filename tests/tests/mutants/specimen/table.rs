//! Sections 6 and 4 of the page as data: what a request does in each state.

use lashloop_protocol::enums::{Outcome, State};

use crate::mutation::Sites;

/// A cell of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// Done, with the state afterwards.
    Done(State),
    Refused(Outcome),
}

use Cell::{Done, Refused};
use Outcome::*;
use State::*;

const EVERYWHERE: [Cell; 5] = [Done(Boot), Done(Idle), Done(Armed), Done(Running), Done(Faulted)];
const fn all(cell: Cell) -> [Cell; 5] {
    [cell; 5]
}
const NO: Cell = Refused(WrongState);
const STRANGER: Cell = Refused(WrongSession);

type Row = (&'static str, [Cell; 5]);

const TABLE: [Row; 20] = [
    ("Hello, another session", [Done(Idle), Done(Idle), Done(Idle), Done(Idle), Done(Faulted)]),
    ("Hello, same session", EVERYWHERE),
    ("Hello, another version", all(Refused(VersionMismatch))),
    ("DescribeParameter", EVERYWHERE),
    ("GetParameter", EVERYWHERE),
    ("SetParameter", [NO, Done(Idle), NO, NO, NO]),
    ("SetParameter, live", [NO, Done(Idle), Done(Armed), Done(Running), NO]),
    ("Arm", [STRANGER, Done(Armed), NO, NO, NO]),
    ("Arm, another session", all(STRANGER)),
    ("Start", [STRANGER, NO, Done(Running), NO, NO]),
    ("Start, another session", all(STRANGER)),
    ("Stop", [NO, Done(Idle), Done(Idle), Done(Idle), NO]),
    ("EmergencyStop", all(Done(Faulted))),
    ("ClearFault", [NO, NO, NO, NO, Done(Idle)]),
    ("Reset", all(Done(Boot))),
    ("DescribeLaw", EVERYWHERE),
    ("DescribeSignal", EVERYWHERE),
    ("DescribeChoice", EVERYWHERE),
    ("Subscribe", [NO, Done(Idle), Done(Armed), Done(Running), NO]),
    ("EncoderSample", [NO, Done(Idle), Done(Armed), Done(Running), Done(Faulted)]),
];

/// What a request does in the present state.
pub fn cell(at: &Sites, request: &'static str) -> Cell {
    let state = at.state.get();
    let (_, cells) = TABLE.iter().find(|(name, _)| *name == request).expect("a row of the table");
    let refusals = Outcome::ALL.iter().filter(|it| **it != Accepted).map(|it| Refused(*it));
    let all: Vec<_> = State::ALL.iter().map(|it| Done(*it)).chain(refusals).collect();
    at.pick(request, state.name(), cells[usize::from(state.byte()) - 1], &all)
}
